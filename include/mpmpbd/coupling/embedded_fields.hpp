// What `Embedded` remembers and reports.
#pragma once

#include <mpmpbd/needle/fields.hpp>
#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd {

// Points in the order of the exchange: one per bead, the needle's (its tip first), attachments.
struct ContactPoints {
  static constexpr FixedString name = "contact point";
};

namespace contact {
struct Impulse : Field<"J", "N s", Vector, ContactPoints> {
};  // of the last substep, body on tissue
struct Covered : Field<"theta", "1", Number, ContactPoints> {};  // tissue around the point, 1: full
}  // namespace contact

namespace bead {
struct Impulse : Field<"lambda", "N s", Number, Beads> {};  // of the segment that starts here
struct Tension : Field<"tension", "N", Number, Beads> {};   // its mean over the last step
struct PeakTension : Field<"tension_peak", "N", Number, Beads> {};
}  // namespace bead

// Tissue on needle: force and moment about the arc's centre, mean over the last step, and the largest force
// of its substeps. The pull of the thread is apart.
namespace needle {
struct Force : Field<"force", "N", Vector, Needles> {};
struct Moment : Field<"moment", "N m", Vector, Needles> {};
struct PeakForce : Field<"force_peak", "N", Number, Needles> {};
struct TipForce : Field<"tip_force", "N", Number, Needles> {};  // axial, mean over the last step
struct ThreadPull : Field<"thread_pull", "N", Number, Needles> {};  // tension of the swaged segment
using Report = Fields<Force, Moment, PeakForce, TipForce, ThreadPull>;
}  // namespace needle

}  // namespace mpmpbd
