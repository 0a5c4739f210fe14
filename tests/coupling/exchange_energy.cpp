// Energy, momentum and order: what one exchange must keep, whatever the state.
// seconds: 80
#include "catch.hpp"

#include <cstdlib>

#include "coupling/random_rig.hpp"
#include "support/sanitized.hpp"

namespace {

using namespace test;
using mpmpbd::dot;
using mpmpbd::norm;

using Q = mpmpbd::QuadraticBSpline;
using Slippery = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
using Rough = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, false>;
using RoughDragged = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::Drag, false>;
using Bending = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::NoDrag, true>;
using Dragged = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::Drag, true>;

struct Gain {
  double worst = -1;
  int raised = 0, slid = 0, opened = 0;
  int unrevised = 0;  // exchanges that began with holds of the one before, of which none was wrong
  double pull = 0;    // the largest impulse with which a one-sided point pulled, relative
};

// What comes before the exchange that is looked at.
enum class Before { any_impulses, an_exchange };

// Carries impulses as an exchange of the same state leaves them.
template <class T, class Form> void carry_own_impulses(Rig<T, Form>& r) {
  auto tried = r;
  auto x = tried.view();
  mpmpbd::place_thread_points(mpmpbd::Solo{}, x);
  mpmpbd::embed_points(mpmpbd::Solo{}, x, tried.nodes());
  for (std::size_t q = 0; q < r.points.size(); ++q) tried.points[q].axis = r.points[q].axis;
  REQUIRE(mpmpbd::exchange(mpmpbd::Solo{}, x, tried.nodes()) == 0u);
  for (std::size_t q = 0; q < r.points.size(); ++q) r.points[q].impulse = tried.points[q].impulse;
  r.previous_dt = r.dt;
}

template <class T, class Form>
Gain survey(int count, Extras const& extra, double tolerance, Before history, unsigned seed = 1) {
  Draw d(seed);
  Gain gain;
  for (int n = 0; n < count; ++n) {
    auto r = random_rig<T, Form>(d, extra);
    if (r.stretch_compliance == 0)  // E_c is defined for inextensible threads of the right length
      for (std::size_t k = 0; k + 1 < r.bead.size(); ++k)
        r.rest_length[k] = norm(r.bead[k + 1] - r.bead[k]);
    auto x = r.view();
    mpmpbd::place_thread_points(mpmpbd::Solo{}, x);
    for (auto& p : r.points)
      if (p.contact == Contact::surface) {  // its axis is the normal of the surface
        p.axis = mpmpbd::direction(d.arrow<T>());
      }
    if (history == Before::an_exchange) carry_own_impulses(r), x.previous_dt = r.previous_dt;
    mpmpbd::embed_points(mpmpbd::Solo{}, x, r.nodes());
    std::vector<mpmpbd::Joint<T>> joints(r.bead.size());
    if constexpr (Form::bends)
      for (int k = 0; k < r.beads(); ++k)
        joints[static_cast<std::size_t>(k)] =
            mpmpbd::detail::bend_joint(x.thread, x.thread_work.links, x.thread_work.length, k);
    double const before = kinetic_energy(r) + thread_energy(r, false, joints);
    REQUIRE(mpmpbd::exchange(mpmpbd::Solo{}, x, r.nodes()) == 0u);
    double const after = kinetic_energy(r) + thread_energy(r, true, joints);
    gain.worst = std::max(gain.worst, after / before - 1);
    gain.raised += after > before * (1 + tolerance);
    gain.unrevised += x.scratch->resumed > 0 && x.scratch->revised == 0;
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

template <class T, class Form>
void no_gain(int draws, Extras const& extra, char const* what,
             Before history = Before::any_impulses) {
  int const count = repeats(draws);
  double const tolerance = sizeof(T) == 4 ? 1e-5 : 1e-12;
  Gain const g = survey<T, Form>(count, extra, tolerance, history);
  INFO(what << ": worst gain " << g.worst << ", raised " << g.raised << " of " << count
            << ", sliding " << g.slid << ", open or full " << g.opened << ", pull " << g.pull);
  if (std::getenv("MPMPBD_TELL")) WARN("gain " << g.worst);
  CHECK(g.raised == 0);
  if (Form::FrictionLaw::grips) CHECK(g.slid > count);  // the states do make points slide
  if (extra.one_sided) CHECK(g.opened > count / 4);
  if (history == Before::an_exchange) CHECK(g.unrevised > count / 100);
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

TEMPLATE_TEST_CASE("one-sided points do not raise the energy", "[coupling][energy]", double,
                   float) {
  no_gain<TestType, Slippery>(5000, {.one_sided = true}, "without friction");
  no_gain<TestType, Rough>(5000, {.needle = true, .one_sided = true}, "friction, tip");
}

// With holds of the exchange before as well, also where no trial finds them wrong.
TEMPLATE_TEST_CASE("no exchange that goes on raises the energy", "[coupling][energy][warm_start]",
                   double, float) {
  auto const after = Before::an_exchange;
  no_gain<TestType, Rough>(10000, {}, "with friction", after);
  no_gain<TestType, RoughDragged>(2000, {}, "friction and drag", after);
  no_gain<TestType, Bending>(2000, {.needle = true, .swage = true}, "swaged needle", after);
  no_gain<TestType, Rough>(5000, {.needle = true, .one_sided = true}, "friction, tip", after);
}
