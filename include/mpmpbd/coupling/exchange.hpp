// The exchange of momentum between tissue, needle and thread in one substep: the heart of `Embedded`.
//
// After grid forces and walls and before gather, once per substep. Everything that bends, weighs or pushes
// the thread has acted on its velocities before; nothing may move thread or needle afterwards. Lateral
// contact, friction and drag meet the thread's stretch and bending in one direct solve, so a taut thread
// cannot cut through tissue between two solvers.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/coupling/hold_search.hpp>
#include <mpmpbd/coupling/thread_solve.hpp>

namespace mpmpbd {

namespace detail {

template <class Team_, class T, class Form, class Nodes> struct Exchange {
  using Scalar = T;
  using Team = Team_;
  using View = ExchangeView<T, Form>;
  using Law = ContactLaw<T, typename Form::FrictionLaw, typename Form::DragLaw>;

  Team_ const& team;
  View const& x;
  Nodes const& nodes;
  Law law;
  ThreadSolve<Team_, T, Form> thread;

  MPMPBD_HD Exchange(Team_ const& team_, View const& x_, Nodes const& nodes_)
      : team(team_), x(x_), nodes(nodes_), law{x_.dt, x_.friction, x_.drag}, thread{team_, x_} {}

  MPMPBD_HD bool dynamic() const { return x.needle->motion == Motion::dynamic; }

  // -- the bodies' side -------------------------------------------------------------------------------

  // N V: the body's velocity at point q in the present trial, and without tissue.
  MPMPBD_HD Vec3<T> body_velocity(int q) const {
    return body_velocity(q, x.thread_work.trial, x.scratch->body());
  }
  MPMPBD_HD Vec3<T> velocity_alone(int q) const {
    return body_velocity(q, x.thread_work.alone, x.scratch->alone());
  }
  MPMPBD_HD Vec3<T> body_velocity(int q, Column<T> const* beads, Vec<T, 6> const& needle) const {
    ContactPoint<T> const& p = x.points[q];
    if (p.segment < 0) return velocity_at(needle, p.position - x.needle->centre);
    return add_product((1 - p.along) * beads[p.segment].bead(), p.along,
                       beads[p.segment + 1].bead());
  }

  // Calls f(q, share) for the points that act on bead k, in a fixed order.
  template <class F> MPMPBD_HD void for_each_point_of_bead(int k, F const& f) const {
    int const end = min(k + 2, x.thread_points());
    for (int q = max(k - 1, 0); q < end; ++q) visit(q, k, f);
    for (int q = x.first_attached(); q < x.count(); ++q) visit(q, k, f);
  }
  template <class F> MPMPBD_HD void visit(int q, int k, F const& f) const {
    if (!x.on[q]) return;
    ContactPoint<T> const& p = x.points[q];
    if (p.segment == k) f(q, 1 - p.along);
    if (p.segment == k - 1) f(q, p.along);
  }

  MPMPBD_HD Vec3<T> apply(Response<T> const& b, int q, Vec3<T> const& a) const {
    Vec3<T> const& d = x.points[q].axis;
    return x.work[q].per_D * add_product(b.isotropic * a, b.axial * dot(d, a), d);
  }
  // How every point answers with its present hold: B, and B u - J - offset.
  MPMPBD_HD void respond() const {
    team.each(x.count(), [&](int q) {
      if (!x.on[q]) return;
      PointWork<T>& w = x.work[q];
      Response<T> const b = law.response(x.points[q], w.hold, w.J, w.D, w.slip_impulse);
      w.response = b;
      w.load = apply(b, q, w.u) - w.J - b.offset;
    });
    team.sync();
  }

  // Rows and right-hand side of the thread and the needle with the contact of the present holds. A bead's contact is the
  // work of three lanes: column c of A and U, and component c of r.
  MPMPBD_HD void assemble_contact() const {
    int const first = thread.head();
    team.each(3 * (x.thread.beads - first), [&](int i) { assemble_bead(first + i / 3, i % 3); });
    team.each(dynamic() ? 7 : 0, [&](int column) { assemble_needle(column); });
    reset_kinematic(x.scratch->body(), T(1));
    team.sync();
  }
  MPMPBD_HD Column<T> side_without_contact(int k) const {
    auto const& t = x.thread_work;
    return Column<T>::of(t.inertia[k], k > 0 ? t.gap_speed[k - 1] : T(0));
  }
  MPMPBD_HD void assemble_bead(int k, int c) const {
    auto const& t = x.thread_work;
    Vec3<T> A{}, U{};
    Column<T> const own = side_without_contact(k);
    T r = own[c];
    for_each_point_of_bead(k, [&](int q, T share) {
      PointWork<T> const& w = x.work[q];
      Vec3<T> const& d = x.points[q].axis;
      Vec3<T> B = (w.per_D * w.response.axial * d[c]) * d;
      B[c] = multiply_add(w.per_D, w.response.isotropic, B[c]);
      A = add_product(A, square(share), B);
      if (x.points[q].segment == k) U = add_product(U, share * (1 - share), B);
      if (!x.thread.known[k]) r = multiply_add(share, w.load[c], r);
    });
    t.rows[k].A(c) = {t.base[k].A(c) + Column<T>::of(A, T(0))};
    t.rows[k].U(c) = {t.base[k].U(c) + Column<T>::of(U, T(0))};
    t.trial[k][c] = r;
    if (c == 0) t.trial[k][3] = own.link();
  }

  // One column of the dynamic needle's matrix; the seventh is its right-hand side.
  MPMPBD_HD void assemble_needle(int column) const {
    Vec<T, 6> sum{}, unit{};
    if (column < 6) {
      unit[column] = T(1);
      inertia_column(column, sum);
    } else {
      sum = x.scratch->momentum;
    }
    for (int q = x.thread_points(); q < x.first_attached(); ++q) {
      if (!x.on[q]) continue;
      Vec3<T> const arm = x.points[q].position - x.needle->centre;
      PointWork<T> const& w = x.work[q];
      Vec3<T> const f = column < 6 ? apply(w.response, q, velocity_at(unit, arm)) : w.load;
      sum += lift(arm, f);
    }
    if (column == 6)
      x.scratch->body() = sum;
    else
      for (int i = 0; i < 6; ++i) x.scratch->end.matrix(i, column) = sum[i];
  }
  MPMPBD_HD void inertia_column(int column, Vec<T, 6>& sum) const {
    if (column < 3)
      sum[column] = x.needle->mass;
    else
      for (int i = 0; i < 3; ++i) sum[3 + i] = x.needle->inertia(i, column - 3);
  }
  // A kinematic needle has no unknowns: its velocity is what it is (factor 1) or does not change (0).
  MPMPBD_HD void reset_kinematic(Vec<T, 6>& body, T factor) const {
    if (dynamic()) return;
    team.one([&] {
      for (int i = 0; i < 3; ++i) {
        body[i] = factor * x.needle->velocity[i];
        body[3 + i] = factor * x.needle->spin[i];
      }
    });
  }

  // -- the grid's side --------------------------------------------------------------------------------

  MPMPBD_HD void load_nodes() const {
    team.each(x.incidence.count(), [&](int i) {
      TouchedNode<T>& n = x.incidence.nodes[i];
      n.velocity = n.start = nodes.velocity(n.index);
      n.inverse_mass = nodes.inverse_mass(n.index);
      n.free_inverse_mass = T(1) / nodes.mass(n.index);
    });
    team.sync();
  }
  MPMPBD_HD void store_nodes() const {
    team.each(x.incidence.count(), [&](int i) {
      TouchedNode<T> const& n = x.incidence.nodes[i];
      nodes.set_velocity(n.index, n.velocity);
    });
    team.sync();
  }
  // Velocity changes of all touched nodes by an impulse at every point.
  template <class Impulse, class Use>
  MPMPBD_HD void push_nodes(Impulse const& impulse, Use const& use) const {
    team.each(x.incidence.count(), [&](int i) {
      TouchedNode<T>& n = x.incidence.nodes[i];
      Vec3<T> change = sum_over_points(x.incidence, i, impulse);
      for (int a = 0; a < 3; ++a) change[a] *= n.inverse_mass[a];
      use(n, change);
    });
    team.sync();
  }

  // A bead without segments has no tangent, and at the swage stands the needle's own last point.
  MPMPBD_HD bool meets_tissue(int q) const {
    if (q >= x.thread_points()) return true;
    ContactPoint<T> const& p = x.points[q];
    bool const at_swage = x.needle_points > 0 && T(p.segment) + p.along == T(x.thread.held);
    return detail::is_segment(x.thread, p.segment) && !at_swage;
  }

  // -- the steps --------------------------------------------------------------------------------------

  MPMPBD_HD std::uint32_t begin() const {
    team.each(x.count(), [&](int q) {
      ContactPoint<T> const& p = x.points[q];
      x.on[q] = p.contact != Contact::off && p.coverage > T(0) && meets_tissue(q);
    });
    team.one([&] {
      ExchangeScratch<T>& s = *x.scratch;
      RigidBody<T> const& b = *x.needle;
      s.failed = s.revised = s.resumed = 0;
      s.end.present = dynamic();
      s.end.swaged = dynamic() && b.swaged && x.thread.beads > 0;
      s.end.arm = x.thread.beads > 0 ? x.thread.position[x.thread.beads - 1] - b.centre : Vec3<T>{};
      Vec3<T> const p = b.mass * b.velocity, L = b.inertia * b.spin;
      s.momentum = {{p[0], p[1], p[2], L[0], L[1], L[2]}};
    });
    team.sync();
    std::uint32_t const faults =
        connect(team, x.incidence, x.count(), x.on, [&](int q) { return firmness(x.points[q]); });
    thread.find_head();
    load_nodes();
    T const scale = x.previous_dt > T(0) ? x.dt / x.previous_dt : T(1);
    team.each(x.thread.beads, [&](int k) { x.thread.impulse[k] *= scale; });
    team.each(x.count(), [&](int q) {
      PointWork<T>& w = x.work[q];
      w = {};
      if (!x.on[q]) return;
      T const firm = firmness(x.points[q]), D = splitting(x.incidence, q);
      w.compliance = D * (T(1) / firm - T(1));
      w.D = D / firm + w.compliance;
      w.per_D = T(1) / w.D;
      w.J = law.carried(x.points[q], scale * x.points[q].impulse);
      w.hold = Hold::open;
    });
    team.sync();
    assemble_thread(team, x.thread, x.thread_work, x.dt);
    return faults;
  }

  // `given`: whether the impulses have been.
  MPMPBD_HD void observe(bool given = true) const {
    team.each(x.count(), [&](int q) {
      PointWork<T>& w = x.work[q];
      if (!x.on[q]) return;
      w.u = grid_velocity(x.incidence, q);
      if (given) w.u = add_product(w.u, w.compliance, w.J);
    });
    team.sync();
  }

  // Thread and needle as they move without tissue; where tissue is met, their response to the impulses on offer, too.
  MPMPBD_HD void move_alone() const {
    auto const& t = x.thread_work;
    bool const offers = touches_tissue();
    observe(false);
    team.each(dynamic() ? 6 : 0, [&](int column) {
      Vec<T, 6> sum{};
      inertia_column(column, sum);
      for (int i = 0; i < 6; ++i) x.scratch->end.matrix(i, column) = sum[i];
    });
    team.each(x.thread.beads, [&](int k) {
      t.alone[k] = side_without_contact(k);
      t.rows[k] = t.base[k];
    });
    team.one([&] {
      if (dynamic()) x.scratch->alone() = x.scratch->momentum;
    });
    reset_kinematic(x.scratch->alone(), T(1));
    if (offers) offer();
    team.sync();
    thread.solve_alone(offers);
    if (offers)
      remember_alone();
    else
      stay_alone();
  }
  // Where none is, that motion is the answer.
  MPMPBD_HD bool touches_tissue() const { return x.incidence.count() > 0; }
  MPMPBD_HD void stay_alone() const {
    team.each(x.thread.beads, [&](int k) { x.thread_work.trial[k] = x.thread_work.alone[k]; });
    team.one([&] { x.scratch->body() = x.scratch->alone(); });
    team.sync();
  }
  // The end of a substep without tissue: where every line search starts.
  MPMPBD_HD void remember_alone() const {
    team.each(x.count(), [&](int q) {
      if (x.on[q]) x.work[q].slip = x.work[q].u - velocity_alone(q);
    });
    team.sync();
  }

  // Right-hand side of the response to the offered impulses: -N^T j, everything else at rest.
  MPMPBD_HD void offer() const {
    team.each(x.thread.beads, [&](int k) {
      Vec3<T> r{};
      if (!x.thread.known[k])
        for_each_point_of_bead(k, [&](int q, T share) { r = add_product(r, -share, x.work[q].J); });
      x.thread_work.trial[k] = Column<T>::of(r, T(0));
    });
    team.one([&] {
      if (!dynamic()) return;
      Vec<T, 6> sum{};
      for (int q = x.thread_points(); q < x.first_attached(); ++q)
        if (x.on[q]) sum -= lift(x.points[q].position - x.needle->centre, x.work[q].J);
      x.scratch->body() = sum;
    });
    reset_kinematic(x.scratch->body(), T(0));
  }

  // Offers last substep's impulses again, scaled by the exact minimiser of the energy along them.
  MPMPBD_HD void warm_start() const {
    push_nodes([&](int q) { return x.work[q].J; },
               [](TouchedNode<T>& n, Vec3<T> const& dv) { n.change = dv; });
    line_search();
    T const share = x.scratch->share;
    team.each(x.incidence.count(), [&](int i) {
      TouchedNode<T>& n = x.incidence.nodes[i];
      n.velocity = add_product(n.velocity, share, n.change);
    });
    team.each(x.count(), [&](int q) { x.work[q].J *= share; });
    team.sync();
  }

  // u - N V as the warm start leaves it, before any trial: `trial` has the response to the whole offer still.
  MPMPBD_HD Vec3<T> slip_at_start(int q) const {
    return x.work[q].u - add_product(velocity_alone(q), x.scratch->share, body_velocity(q));
  }

  // Adds two numbers f(q) up over the points that are on, in their order; one lane gives the sums to use(sums).
  template <class F, class Use> MPMPBD_HD void sum_over_all(F const& f, Use const& use) const {
    team.each(x.count(), [&](int q) { x.work[q].terms = x.on[q] ? f(q) : Vec<T, 2>{}; });
    team.sync();
    team.one([&] {
      Vec<T, 2> sum{};
#if defined(__CUDA_ARCH__)
#pragma unroll 8
#endif
      for (int q = 0; q < x.count(); ++q) sum += x.work[q].terms;
      use(sum);
    });
    team.sync();
  }
  // Sets the share of the offer: the thread's response to it is in `trial`, the grid's in `change`.
  MPMPBD_HD void line_search() const {
    sum_over_all(
        [&](int q) {
          Vec3<T> const& j = x.work[q].J;
          Vec3<T> const moved = sum_over_nodes<Vec3<T>>(
              x.incidence, q, [](Vec3<T> const& sum, T w, TouchedNode<T> const& n) {
                return add_product(sum, w, n.change);
              });
          return Vec<T, 2>{
              {dot(j, x.work[q].slip),
               dot(j, add_product(moved, x.work[q].compliance, j) - body_velocity(q))}};
        },
        [&](Vec<T, 2> const& sum) {
          T const power = sum[0], stiffness = sum[1];
          x.scratch->share = stiffness > T(0) ? clamp(-power / stiffness, T(0), T(1)) : T(0);
        });
  }

  MPMPBD_HD void pass() const {
    respond();
    assemble_contact();
    thread.solve_contact();
    team.each(x.count(), [&](int q) {
      if (!x.on[q]) return;
      PointWork<T>& w = x.work[q];
      w.dJ = w.response.offset - apply(w.response, q, w.u - body_velocity(q));
    });
    team.sync();
  }

  // After observe(). The first sweep begins as the last substep ended; what it cannot tell is tried in stick. The
  // second goes on with what the first found, at the friction of the lateral load it left. The load of the
  // stick trial itself is not that load: in a bend, points that hold a moving thread along also press it
  // aside, by about v m / dt.
  MPMPBD_HD void sweep(bool first) const {
    team.each(x.count(), [&](int q) {
      if (!x.on[q]) return;
      ContactPoint<T> const& p = x.points[q];
      PointWork<T>& w = x.work[q];
      w.hold = first ? law.begins(p, w.J, slip_at_start(q), w.slip_impulse)
                     : law.resumes(p, w.hold, w.J, w.slip_impulse);
      if (first && Law::is_limit(w.hold)) team.add(x.scratch->resumed, 1);
    });
    team.sync();
    HoldSearch<Exchange>(*this).find(first);
    push_nodes([&](int q) { return x.work[q].dJ; },
               [](TouchedNode<T>& n, Vec3<T> const& dv) { n.velocity += dv; });
    team.each(x.count(), [&](int q) {
      if (x.on[q]) x.work[q].J += x.work[q].dJ;
    });
    team.sync();
  }

  // Friction and one-sided contact choose their holds by trial, or as the last substep did, which is not a proof. Along the line from
  // the motion without tissue (share 0) to the motion found (share 1) the energy is a parabola: where it
  // would end higher than it began, its minimum is taken. All limits are cones, so they hold there too.
  MPMPBD_HD void guard_energy() const {
    if (x.scratch->revised == 0 && x.scratch->resumed == 0) return;
    observe();
    find_safe_share();
    T const share = x.scratch->share;
    if (share == T(1)) return;
    auto const& t = x.thread_work;
    team.each(x.incidence.count(), [&](int i) {
      TouchedNode<T>& n = x.incidence.nodes[i];
      n.velocity = add_product(n.start, share, n.velocity - n.start);
    });
    team.each(x.thread.beads, [&](int k) {
      t.trial[k] = {add_product(t.alone[k], share, t.trial[k] - t.alone[k])};
    });
    team.each(x.count(), [&](int q) { x.work[q].J *= share; });
    team.one([&] {
      Vec<T, 6> const& alone = x.scratch->alone();
      x.scratch->body() = add_product(alone, share, x.scratch->body() - alone);
    });
    team.sync();
  }
  MPMPBD_HD void find_safe_share() const {
    sum_over_all(
        [&](int q) {
          PointWork<T> const& w = x.work[q];
          return Vec<T, 2>{{dot(w.J, w.slip), dot(w.J, w.u - body_velocity(q))}};
        },
        [&](Vec<T, 2> const& sum) {
          T const before = sum[0], after = sum[1];
          T const least = before < T(0) && after > before
                              ? clamp(-before / (after - before), T(0), T(1))
                              : T(0);
          x.scratch->share = before + after > T(0) ? least : T(1);
        });
  }

  MPMPBD_HD void finish() const {
    store_nodes();
    auto const& t = x.thread_work;
    team.each(x.thread.beads, [&](int k) {
      x.thread.velocity[k] = t.trial[k].bead();
      x.thread.position[k] = add_product(x.thread.position[k], x.dt, x.thread.velocity[k]);
      x.thread.impulse[k] = k + 1 < x.thread.beads ? t.trial[k + 1].link() : T(0);
    });
    team.each(x.count(), [&](int q) { x.points[q].impulse = x.on[q] ? x.work[q].J : Vec3<T>{}; });
    team.one([&] {
      if (!dynamic()) return;
      Vec<T, 6> const& y = x.scratch->body();
      x.needle->velocity = vec(y[0], y[1], y[2]);
      x.needle->spin = vec(y[3], y[4], y[5]);
    });
    team.sync();
  }

  // Without a solution nothing is exchanged; so no impulse is reported, and none is offered again.
  MPMPBD_HD void give_up() const {
    team.each(x.thread.beads, [&](int k) { x.thread.impulse[k] = T(0); });
    team.each(x.count(), [&](int q) { x.points[q].impulse = Vec3<T>{}; });
    team.sync();
  }
};

}  // namespace detail

// Exchanges momentum. Before: place_thread_points, needle points placed, embed_points, contacts decided.
// After: node velocities, bead positions and velocities, link impulses, a dynamic needle's velocity and
// the impulse of every point are those of the end of the substep. Returns faults; with Fault::solver
// nothing was moved and every impulse is zero.
//
// nodes: mass(i) > 0 where it has mass, inverse_mass(i) per axis, velocity(i), set_velocity(i, v).
template <class Team_, class T, class Form, class Nodes>
MPMPBD_APART std::uint32_t exchange(Team_ const& team, ExchangeView<T, Form> const& x,
                                    Nodes const& nodes, int sweeps = 2) {
  detail::Exchange<Team_, T, Form, Nodes> const e(team, x, nodes);
  std::uint32_t const faults = e.begin();
  e.move_alone();
  if (e.touches_tissue()) {
    e.warm_start();
    MPMPBD_NO_UNROLL
    for (int i = 0; i < sweeps; ++i) {
      e.observe();
      e.sweep(i == 0);
    }
    e.thread.solve_head();
    e.guard_energy();
  }
  if (x.scratch->failed != 0) {
    e.give_up();
    return faults | static_cast<std::uint32_t>(Fault::solver);
  }
  e.finish();
  return faults;
}

// Force and moment of a needle about `centre`, as the tissue exerts them [N, N m]. The pull of a swaged
// thread is not in it.
template <class T> struct Wrench { Vec3<T> force, moment; };
template <class T, class Form>
MPMPBD_HD Wrench<T> needle_wrench(ExchangeView<T, Form> const& x, Vec3<T> const& centre) {
  Wrench<T> sum{};
  for (int q = x.thread_points(); q < x.first_attached(); ++q) {
    Vec3<T> const f = T(-1) / x.dt * x.points[q].impulse;
    sum.force += f;
    sum.moment += cross(x.points[q].position - centre, f);
  }
  return sum;
}

// Tension of segment k [N]; negative in compression.
template <class T, class Form> MPMPBD_HD T tension(ExchangeView<T, Form> const& x, int k) {
  return x.thread.impulse[k] / x.dt;
}

}  // namespace mpmpbd
