// The status word: trouble during a run sets a bit of its own environment and never touches another.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include <mpmpbd/core/field.hpp>

namespace mpmpbd {

enum class Fault : std::uint32_t {
  time_step = 1u << 0,   // a substep was longer than its stability limit
  not_finite = 1u << 1,  // a NaN or infinity appeared; the environment is frozen
  inversion = 1u << 2,   // a material that needs det F > 0 met det F <= 0
  escape = 1u << 3,      // a particle reached the border of the domain and was held there
  speed = 1u << 4,       // something moved more than one cell in a substep
  overflow = 1u << 5,    // a capacity was exceeded, or masses are too far apart for a device's sums
  fracture = 1u << 6,  // tissue was stretched so far that its particles part (effect StretchLimit)
  dimple = 1u << 7,    // the tip pressed deeper than 1.5 cells without reaching its threshold
  penetration = 1u << 8,  // a point sank more than half a cell without a puncture
  solver = 1u << 9,       // a direct solve met a singular matrix and left its unknowns unchanged
};

struct FaultInfo {
  Fault fault;
  std::string_view name;
  std::string_view meaning;
};

inline constexpr std::array<FaultInfo, 10> fault_table{{
    {Fault::time_step, "time_step", "a substep was longer than its stability limit"},
    {Fault::not_finite, "not_finite", "a NaN or infinity appeared; the environment is frozen"},
    {Fault::inversion, "inversion", "det F <= 0 in a material that needs det F > 0"},
    {Fault::escape, "escape", "a particle reached the border of the domain and was held there"},
    {Fault::speed, "speed", "something moved more than one cell in a substep"},
    {Fault::overflow, "overflow",
     "a capacity was exceeded and the item left out, or masses lie too far apart for sums on a device"},
    {Fault::fracture, "fracture",
     "tissue was stretched beyond the limit that its particles can tell"},
    {Fault::dimple, "dimple", "the tip pressed deeper than 1.5 cells without puncture"},
    {Fault::penetration, "penetration", "a point sank more than half a cell without puncture"},
    {Fault::solver, "solver", "a direct solve met a singular matrix"},
}};

MPMPBD_HD constexpr std::uint32_t operator|(Fault a, Fault b) {
  return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b);
}
MPMPBD_HD constexpr bool has(std::uint32_t word, Fault f) {
  return (word & static_cast<std::uint32_t>(f)) != 0;
}

inline constexpr int fault_count = static_cast<int>(fault_table.size());

// What bounds the length of a substep.
enum class StepBound : std::int64_t {
  none,     // nothing in the scene does
  elastic,  // elastic and viscous waves
  speed,    // half a cell of motion
  strain,   // half a unit of strain
};

// Fields of one environment. All of them are state: saved, reset and cloned with the rest.
namespace environment {
struct Status : Field<"status", "bits", Integer, Environments> {};  // sticky until reset
// How often each fault of fault_table was met since reset; at most once per substep.
struct FaultCount : Field<"faults", "1", Integers<fault_count>, Environments> {};
struct Step : Field<"step", "1", Integer, Environments> {};  // substeps since reset
struct Time : Field<"time", "ps", Integer, Environments> {
};  // since reset; a float sum would stall
struct Substeps : Field<"substeps", "1", Integer, Environments> {};  // taken in the last step
struct Dt : Field<"dt", "s", Number, Environments> {};               // last substep length
struct DtLimit : Field<"dt_limit", "s", Number, Environments> {};   // stable limit at the last step
struct DtBound : Field<"dt_bound", "1", Integer, Environments> {};  // a StepBound: what set it
// What substeps that are chosen hold on to (scene/held_limit.hpp): limit and longer [s]; calm steps.
struct HeldLimits : Field<"held_limits", "s", Numbers<2>, Environments> {};
struct CalmSteps : Field<"calm_steps", "1", Integer, Environments> {};
struct Seed : Field<"seed", "1", Integer, Environments> {};
struct Episode : Field<"episode", "1", Integer, Environments> {};  // resets so far
}  // namespace environment

}  // namespace mpmpbd
