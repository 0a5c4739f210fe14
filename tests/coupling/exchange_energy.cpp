// Energy, momentum and order: what one exchange must keep, whatever the state.
#include "catch.hpp"

#include "coupling/rig.hpp"

namespace {

using namespace test;
using mpmpbd::cross;
using mpmpbd::dot;
using mpmpbd::norm;
using mpmpbd::vec;

using Q = mpmpbd::QuadraticBSpline;
using Slippery = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
using Rough = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, false>;
using RoughDragged = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::Drag, false>;
using Bending = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, true>;
using Dragged = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::Drag, true>;

struct Draw {
  std::mt19937 random;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit{0, 1};
  double log_uniform(double a, double b) { return a * std::pow(b / a, unit(random)); }
  template <class T> Vec3<T> arrow() { return vec(T(normal(random)), T(normal(random)), T(normal(random))); }
};

struct Extras {
  bool needle = false, swage = false, one_sided = false, walls = false, kinematic = false;
};

// Random masses over five decades around a thread of random shape, with random speeds, stretch, carried
// impulses, tensions, holes in the tissue and (on request) a needle, tip, surface points and walls.
template <class T, class Form> Rig<T, Form> random_rig(Draw& d, Extras const& extra = {}) {
  Rig<T, Form> r(12, 12, 12);
  // Float: a light free bead that bends stiffly loses its mass in rounding (dt^2 EI / l^3 m > 1e4).
  double const lightest = Form::bends && sizeof(T) == 4 ? 1e-1 : 1e-4;
  double const ratio = d.log_uniform(lightest, 1e4), hole = d.unit(d.random) * 0.4;
  for (std::size_t i = 0; i < r.mass.size(); ++i) {
    if (d.unit(d.random) < hole) continue;
    r.mass[i] = T(d.log_uniform(0.05, 1));
    r.inverse_mass[i] = T(1) / r.mass[i] * vec(T(1), T(1), T(1));
    r.velocity[i] = T(0.1) * d.arrow<T>();
    double const wall = d.unit(d.random);
    if (extra.walls && wall < 0.2) r.inverse_mass[i][static_cast<int>(wall * 15)] = 0;
    if (extra.walls && wall > 0.9) r.inverse_mass[i] = {};
    for (int a = 0; a < 3; ++a)
      if (r.inverse_mass[i][a] == 0) r.velocity[i][a] = 0;
  }
  Vec3<T> x = vec(T(3), T(3), T(3)) + T(0.5) * d.arrow<T>(), heading = mpmpbd::direction(vec(T(1), T(1), T(1)));
  int const beads = 6 + static_cast<int>(d.unit(d.random) * 3);
  for (int k = 0; k < beads; ++k) {
    r.add_bead(x, T(ratio * (0.5 + d.unit(d.random))));
    heading = mpmpbd::direction(heading + T(0.3) * d.arrow<T>());
    x += T(0.4 + 0.6 * d.unit(d.random)) * heading;
    for (int a = 0; a < 3; ++a) x[a] = mpmpbd::clamp(x[a], T(2), T(9));
  }
  for (std::size_t k = 0; k < r.bead.size(); ++k) {
    r.bead_velocity[k] = T(0.1) * d.arrow<T>();
    if (k + 1 < r.bead.size()) r.rest_length[k] *= T(1 + 0.02 * d.normal(d.random));
    r.impulse[k] = T(d.unit(d.random) < 0.5 ? 0 : d.log_uniform(1e-3, 1));
    r.rest_angle[k] = T(d.unit(d.random) < 0.5 ? 0 : d.unit(d.random));
  }
  r.stretch_compliance = d.unit(d.random) < 0.2 ? T(0) : T(d.log_uniform(1e-5, 1e-1));
  r.bending_stiffness = T(d.log_uniform(1e-2, 1e2));
  if constexpr (Form::FrictionLaw::grips) r.friction = {T(d.log_uniform(0.01, 3)), T(d.log_uniform(1e-3, 1))};
  if constexpr (Form::DragLaw::drags) r.drag = {T(d.log_uniform(1e-2, 1e2))};

  std::vector<mpmpbd::ContactPoint<T>> needle;
  if (extra.needle) {
    r.needle.motion = extra.kinematic ? Motion::kinematic : Motion::dynamic;
    r.needle.swaged = extra.swage && !extra.kinematic;
    r.needle.centre = vec(T(6), T(6), T(6));
    r.needle.mass = T(ratio * 3);
    r.needle.inertia = T(ratio) * Mat3<T>::identity();
    r.needle.velocity = extra.kinematic ? Vec3<T>{} : T(0.1) * d.arrow<T>();
    r.needle.spin = extra.kinematic ? Vec3<T>{} : T(0.1) * d.arrow<T>();
    for (int i = 0; i < 8; ++i) {
      double const phi = 0.3 * i;
      mpmpbd::ContactPoint<T> p{};
      p.position = r.needle.centre + vec(T(2.5 * std::cos(phi)), T(2.5 * std::sin(phi)), T(0.4));
      p.axis = vec(T(-std::sin(phi)), T(std::cos(phi)), T(0));
      p.length = T(0.75);
      p.radius = T(0.1);
      p.segment = -1;
      p.contact = Contact::member;
      p.impulse = T(0.05) * d.arrow<T>();
      needle.push_back(p);
    }
    if (extra.one_sided) {
      needle.back().contact = Contact::tip;
      needle.back().force_cap = T(d.log_uniform(1e-2, 10));
    }
  }
  r.allocate(needle);
  for (auto& p : r.points) {
    p.radius = T(0.1);
    p.pressure = T(0.3 * d.normal(d.random));
    if (p.segment >= 0) p.impulse = d.unit(d.random) < 0.3 ? Vec3<T>{} : T(0.05) * d.arrow<T>();
    if (extra.one_sided && p.contact != Contact::tip && d.unit(d.random) < 0.4) p.contact = Contact::surface;
  }
  return r;
}

// The stretch and bending part of E_c, before (from the shape) and after (from the solution).
template <class T, class Form> double thread_energy(Rig<T, Form>& r, bool after, std::vector<mpmpbd::Joint<T>> const& joints) {
  auto x = r.view();
  double e = 0;
  for (int k = 0; k + 1 < r.beads(); ++k) {
    double const c = double(x.thread_work.links[k].compliance), g = double(x.thread_work.gap_speed[k]);
    double const lambda = double(x.thread_work.trial_impulse[k]);
    if (c > 0) e += after ? 0.5 * c * lambda * lambda : 0.5 * g * g / c;
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    double angle = double(joints[k].excess);
    if (after && joints[k].stiffness > 0)
      for (std::size_t a = 0; a < 3; ++a)
        angle += double(r.dt * dot(joints[k].in_plane[a], r.bead_velocity[k - 1 + a]));
    e += 0.5 * double(joints[k].stiffness) * angle * angle;
  }
  return e;
}

struct Gain {
  double worst = -1;
  int raised = 0, slid = 0, opened = 0;
  double pull = 0;  // the largest impulse with which a one-sided point pulled, relative
};

template <class T, class Form> Gain survey(int count, Extras const& extra, double tolerance, unsigned seed = 1) {
  Draw d{std::mt19937(seed), {}};
  Gain gain;
  for (int n = 0; n < count; ++n) {
    auto r = random_rig<T, Form>(d, extra);
    if (r.stretch_compliance == 0)  // E_c is defined for inextensible threads of the right length
      for (std::size_t k = 0; k + 1 < r.bead.size(); ++k) r.rest_length[k] = norm(r.bead[k + 1] - r.bead[k]);
    auto x = r.view();
    mpmpbd::place_thread_points(mpmpbd::Solo{}, x);
    for (auto& p : r.points)
      if (p.contact == Contact::surface) {  // its axis is the normal of the surface
        p.axis = mpmpbd::direction(d.arrow<T>());
      }
    mpmpbd::embed_points(mpmpbd::Solo{}, x, r.nodes());
    std::vector<mpmpbd::Joint<T>> joints(r.bead.size());
    if constexpr (Form::bends)
      for (int k = 0; k < r.beads(); ++k)
        joints[static_cast<std::size_t>(k)] = mpmpbd::detail::bend_joint(x.thread, x.thread_work.links, x.thread_work.length, k);
    double const before = kinetic_energy(r) + thread_energy(r, false, joints);
    REQUIRE(mpmpbd::exchange(mpmpbd::Solo{}, x, r.nodes()) == 0u);
    double const after = kinetic_energy(r) + thread_energy(r, true, joints);
    gain.worst = std::max(gain.worst, after / before - 1);
    gain.raised += after > before * (1 + tolerance);
    double size = 0;
    for (auto const& p : r.points) size = std::max(size, double(norm(p.impulse)));
    for (int q = 0; q < x.count(); ++q) {
      gain.slid += x.work[q].hold == mpmpbd::Hold::slide;
      gain.opened += x.work[q].hold == mpmpbd::Hold::open || x.work[q].hold == mpmpbd::Hold::full;
      auto const& p = r.points[static_cast<std::size_t>(q)];
      if (p.contact == Contact::surface || p.contact == Contact::tip)
        gain.pull = std::max(gain.pull, -double(dot(p.axis, p.impulse)) / size);
    }
  }
  return gain;
}

template <class T, class Form> void no_gain(int count, Extras const& extra, char const* what) {
  double const tolerance = sizeof(T) == 4 ? 1e-5 : 1e-12;
  Gain const g = survey<T, Form>(count, extra, tolerance);
  INFO(what << ": worst gain " << g.worst << ", raised " << g.raised << " of " << count << ", sliding "
            << g.slid << ", open or full " << g.opened << ", pull " << g.pull);
  if (std::getenv("MPMPBD_TELL")) WARN("gain " << g.worst);
  CHECK(g.raised == 0);
  if (Form::FrictionLaw::grips) CHECK(g.slid > count);  // the states do make points slide
  if (extra.one_sided) CHECK(g.opened > count / 4);
}

}  // namespace

TEMPLATE_TEST_CASE("no exchange raises the energy", "[coupling][energy]", double, float) {
  Extras const needle{.needle = true}, swage{.needle = true, .swage = true}, walls{.walls = true};
  no_gain<TestType, Slippery>(10000, {}, "without friction");
  no_gain<TestType, Rough>(10000, {}, "with friction");
  no_gain<TestType, RoughDragged>(2000, {}, "friction and drag");
  no_gain<TestType, Dragged>(2000, {}, "drag and bending");
  no_gain<TestType, Bending>(2000, {}, "friction and bending");
  no_gain<TestType, Rough>(2000, needle, "needle");
  no_gain<TestType, Bending>(2000, swage, "swaged needle");
  no_gain<TestType, Rough>(2000, walls, "walls");
}

TEMPLATE_TEST_CASE("one-sided points do not raise the energy", "[coupling][energy]", double, float) {
  no_gain<TestType, Slippery>(5000, {.one_sided = true}, "without friction");
  no_gain<TestType, Rough>(5000, {.needle = true, .one_sided = true}, "friction, tip");
}
