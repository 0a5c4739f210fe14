// What an exchange works on, and where its points stand.
#pragma once

#include <mpmpbd/coupling/contact_law.hpp>
#include <mpmpbd/coupling/incidence.hpp>
#include <mpmpbd/coupling/thread_blocks.hpp>
#include <mpmpbd/coupling/weights.hpp>

namespace mpmpbd {

// What is known at compile time. `bends`: the thread resists bending.
template <class Shape_, class FrictionLaw_, class DragLaw_, bool bends_> struct EmbeddedForm {
  using Shape = Shape_;
  using FrictionLaw = FrictionLaw_;
  using DragLaw = DragLaw_;
  static constexpr bool bends = bends_;
};

enum class Motion : int { absent, kinematic, dynamic };

// The needle. Its velocity is given (kinematic) or found (dynamic: mass and inertia about `centre`, its
// centre of mass). The caller moves it with the velocity that the exchange leaves.
template <class T> struct RigidBody {
  Motion motion;
  // The last bead of the thread is fixed to it; with a kinematic body it is a known bead.
  bool swaged;
  Vec3<T> centre, velocity, spin;  // [m], [m/s], [rad/s]
  T mass;                          // [kg]
  Mat3<T> inertia;                 // in world axes [kg m^2]
};

// Scratch of one point.
template <class T> struct PointWork {
  T D;           // splitting, and compliance: velocity at the contact per impulse [1/kg]
  T per_D;       // [kg]
  T compliance;  // of a contact that is not firm [1/kg]
  Vec3<T> slip;  // before the exchange, with the thread solved alone [m/s]
  Vec3<T> u;     // tissue velocity there, and what the contact gives way, before a sweep [m/s]
  Vec3<T> J;     // impulse so far [N s]
  Vec3<T> dJ;    // of the present pass [N s]
  Vec3<T> slip_impulse;  // friction that it slides with [N s]
  Response<T> response;  // to the present hold
  Vec3<T> load;          // what it brings to the right-hand side of its body [N s]
  Vec<T, 2> terms;       // what it adds to a sum over points
  Hold hold, next;       // the present one, and what it should be after a trial
};

template <class T> struct ExchangeScratch {
  RigidEnd<T> end;
  Vec<T, 6> momentum;            // the needle's right-hand side without contact [N s, N m s]
  Vec<T, 6> bodies[most_sides];  // alone(), body()
  T share;                       // of the impulses on offer that is taken
  int changed, places;  // holds that the last trial found wrong, and the sum of their places
  int revised;          // whether any was in the whole exchange
  int resumed;          // points that began it at a limit: sliding, or at a cap
  int failed;

  // Velocity and spin of the needle [m/s, rad/s]: with thread and needle solved without tissue, and in the present trial.
  MPMPBD_HD Vec<T, 6>& alone() { return bodies[0]; }
  MPMPBD_HD Vec<T, 6>& body() { return bodies[1]; }
};

// Everything of one environment. Points: one per bead of the thread, then those of the needle, then
// attachments (Contact::tied, anywhere on the thread).
template <class T, class Form> struct ExchangeView {
  using Scalar = T;
  Lattice<T> lattice;
  T rest_density;     // of the tissue [kg/m^3]
  T dt, previous_dt;  // [s]
  ThreadState<T> thread;
  RigidBody<T>* needle;  // never null; Motion::absent without one
  ContactPoint<T>* points;
  int needle_points, attached_points;
  parameters_t<typename Form::FrictionLaw, T> friction;
  parameters_t<typename Form::DragLaw, T> drag;

  ThreadWork<T, Form::bends> thread_work;
  Incidence<T> incidence;
  PointWork<T>* work;
  bool* on;
  ExchangeScratch<T>* scratch;

  MPMPBD_HD int thread_points() const { return thread.beads > 1 ? thread.beads : 0; }
  MPMPBD_HD int first_attached() const { return thread_points() + needle_points; }
  MPMPBD_HD int count() const { return first_attached() + attached_points; }
};

// Puts a point on its thread: at `along`, in [0, 1], of a segment. The tangent goes from bead to bead evenly.
template <class View_, class T>
MPMPBD_HD void place_on_thread(View_ const& x, ContactPoint<T>& p, int segment, T along) {
  p.segment = segment;
  p.along = along;
  auto const between = [along](Vec3<T> const& a, Vec3<T> const& b) {
    return add_product((1 - along) * a, along, b);
  };
  p.position = between(x.thread.position[segment], x.thread.position[segment + 1]);
  p.axis = direction(between(x.thread_work.tangent[segment], x.thread_work.tangent[segment + 1]));
}

// Positions and tangents of the thread's points: its beads. Tissue then asks as much of the thread as the thread
// has unknowns, and all of it can be met by the thread's own motion. Two points per segment ask for more: what
// is left over binds the tissue to itself. One in the middle of each does not see a zigzag (decision 7).
template <class Team_, class View_>
MPMPBD_HD void place_thread_points(Team_ const& team, View_ const& x) {
  using T = typename View_::Scalar;
  measure_segments(team, x.thread, x.thread_work, x.dt);
  bead_tangents(team, x.thread, x.thread_work);
  team.each(x.thread_points(), [&](int q) {
    ContactPoint<T>& p = x.points[q];
    bool const goes_on = detail::is_segment(x.thread, q);
    p.segment = goes_on ? q : q - 1;
    p.along = T(goes_on ? 0 : 1);
    p.position = x.thread.position[q];
    p.axis = x.thread_work.tangent[q];
    T const before = q > 0 ? x.thread.rest_length[q - 1] : T(0);
    p.length = (before + (goes_on ? x.thread.rest_length[q] : T(0))) / 2;
  });
  team.sync();
}

// Mass around a point that has tissue on all sides [kg].
template <class Form, class T> MPMPBD_HD T full_mass(ExchangeView<T, Form> const& x) {
  return x.rest_density * x.lattice.dx * x.lattice.dx * x.lattice.dx;
}
// Weights and coverage of one point.
template <class Form, class T, class Nodes>
MPMPBD_HD void embed_point(ExchangeView<T, Form> const& x, Nodes const& nodes, int q) {
  int const first = q * x.incidence.per_point;
  x.points[q].coverage = embedding_weights<typename Form::Shape>(x.lattice, x.points[q].position,
                                                                 nodes, x.incidence.weight + first,
                                                                 x.incidence.node + first) /
                         full_mass(x);
}
// Weights and coverage of all points. Between this and `exchange` the caller decides what each point is
// (Contact), for which it may read the coverage.
template <class Form, class Team_, class T, class Nodes>
MPMPBD_HD void embed_points(Team_ const& team, ExchangeView<T, Form> const& x, Nodes const& nodes) {
  team.each(x.count(), [&](int q) { embed_point(x, nodes, q); });
  team.sync();
}

}  // namespace mpmpbd
