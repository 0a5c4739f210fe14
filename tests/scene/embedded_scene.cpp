// Embedded in whole scenes, through Simulation: what a scene does not name is not there, and a suturing
// scene in contact is a value - saved, restored, reset, copied and run beside others, bit for bit (B40, B41).
// seconds: 30
// processors: 2
#include <fstream>
#include <sstream>
#include <utility>

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/catalog/scenes.hpp>
#include <mpmpbd/catalog/suturing.hpp>
#include <mpmpbd/io/state_file.hpp>
#include <mpmpbd/scene/plan.hpp>
#include <mpmpbd/testing/batch_laws.hpp>

#include "catch.hpp"
#include "io/scratch.hpp"

using namespace mpmpbd;

namespace {

struct ThreadInTissue
    : Scene<SoftTissue, Pbd<Constraints<Distance, Bend>>, Coupling<Embedded, Friction>, Gravity> {};

template <class S> using FieldsOf = typename S::StateFields;
template <class S, class D> constexpr bool has_domain = on_t<FieldsOf<S>, D>::count > 0;

// Tissue alone: no thread, needle, contact or surface; three stages, none of them of a coupling.
using Tissue = catalog::Tissue;
static_assert(!has_domain<Tissue, Beads> && !has_domain<Tissue, Needles>);
static_assert(!has_domain<Tissue, ContactPoints> && !has_domain<Tissue, Instances<Distance>>);
static_assert(!has_domain<Tissue, SheetVertices> && !has_domain<Tissue, Channels> &&
              !has_domain<Tissue, ChannelPoints> && !has_domain<Tissue, Events> &&
              !has_domain<Tissue, Markers>);
static_assert(std::is_same_v<typename Tissue::Substep::Stages,
                             TypeList<ParticlesToGrid<Tissue::Body, Tissue::Effects>,
                                      MoveNodes<Tissue::Body, Tissue::Effects>,
                                      GridToParticles<Tissue::Body, Tissue::Effects>>>);
static_assert(std::is_same_v<typename State<float, FieldsOf<Tissue>>::Domains,
                             TypeList<Environments, Particles>>);
// Environment, particles and parameters: what a scene stores per environment does not know of the rest.
static_assert(!contains<FieldsOf<Tissue>, ParametersField<Embedded>> &&
              !contains<FieldsOf<Tissue>, ParametersField<ArcNeedle>>);

// A thread in tissue: beads and contact points, but nothing of needle or surface; one more stage. With them,
// two more: what goes with the tissue, and the needle.
static_assert(has_domain<ThreadInTissue, Beads> && has_domain<ThreadInTissue, ContactPoints>);
static_assert(!has_domain<ThreadInTissue, Needles> && !has_domain<ThreadInTissue, SheetVertices> &&
              !has_domain<ThreadInTissue, Channels> && !has_domain<ThreadInTissue, Events>);
static_assert(ThreadInTissue::Substep::Stages::size == 4);
static_assert(Suturing::Substep::Stages::size == 6);
static_assert(has_domain<Suturing, Needles> && has_domain<Suturing, Channels>);

// Counts how far every bead has gone: an effect that acts when the coupling has solved.
struct Travelled : Field<"travelled", "m", Number, Beads> {};
struct Odometer {
  using Role = role::Effect;
  static constexpr FixedString name = "odometer";
  static constexpr Slot slot = Slot::after_solve;
  using Reads = Fields<bead::Velocity, Travelled>;
  using Writes = Fields<Travelled>;
  template <class Item, class K, class T>
  MPMPBD_HD static void apply(Item& bead, K const&, Tick<T> const& tick) {
    bead[Travelled{}] += tick.dt * norm(bead[bead::Velocity{}]);
  }
};
template <class... Parts> Scene<Parts..., Odometer> counted(Scene<Parts...> const&);
using Counted = decltype(counted(Suturing{}));

void check_golden(std::string const& name, std::string const& text) {
  std::string const here = __FILE__;
  std::ifstream in(here.substr(0, here.find_last_of('/')) + "/golden/" + name + ".txt");
  std::stringstream stored;
  stored << in.rdbuf();
  INFO("the plan of " << name << " changed; if that is meant, store the new one");
  CHECK(stored.str() == text);
}

// A small block under preset paper's needle and thread.
SuturingConfig small_config() {
  SuturingConfig c;
  c.tissue.size = vec(1.2, 0.6, 0.6);
  c.tissue.points = Vec<int, 3>{{22, 11, 11}};
  c.tissue.corner = vec(0.9, 0.7, 0.3);
  return c;
}

// The needle turns about its arc's centre: through the surface, and on. Variants differ in stiffness,
// thread and speed.
struct Drive {
  template <class R> void operator()(R& run, std::int64_t env, int which) const {
    using T = typename R::Scalar;
    auto c = small_config();
    c.tissue.young_modulus *= 1 - 0.1 * which;
    c.contact.friction = 0.1 * which;
    suturing::set_up(run, env, c);
    auto const view = run.state().template view<Needles>();
    auto const item = env * view.capacity;
    auto const pose = needle::pose(view, item);
    T const rate = T(16 + which);
    needle::set_twist(
        view, item,
        Twist<T>{{}, rate * quaternion::rotate(pose.orientation, vec(T(0), T(0), T(1)))});
  }
};

testing::BatchCase<Drive> driven(int steps) {
  auto options = suturing::options(small_config());
  options.substeps = 0;
  return {options, Drive{}, 0.004, steps};
}

}  // namespace

TEST_CASE("the plans of scenes are as stored", "[scene][plan]") {
  check_golden("tissue", plan<catalog::Tissue>());
  check_golden("tissue_thread", plan<ThreadInTissue>());
  check_golden("suturing", plan<Suturing>());
}

// What is stored and in which order stages come hangs on the scene; how the grid is kept, on the back end.
TEST_CASE("the plan of a device is that of the host but for its grids", "[scene][plan][cuda]") {
  auto text = plan<Suturing, Cuda>();
  for (auto const& [device, host] : {std::pair{"back end: cuda", "back end: serial"},
                                     std::pair{"node: 32 B each", "node: 16 B each"}}) {
    auto const at = text.find(device);
    REQUIRE(at != std::string::npos);
    text.replace(at, std::string(device).size(), host);
  }
  CHECK(text == plan<Suturing>());
  CHECK(plan<Suturing, Cuda, double>().find("node: 64 B each") != std::string::npos);
}

TEST_CASE("suturing environments in contact do not know of each other", "[scene][batch]") {
  auto const c = driven(14);
  testing::BatchProbe<Suturing, float, Drive> const probe(c);
  auto const& state = probe.reference().state();
  for (int e = 0; e < 4; ++e) {  // the comparison means something: the needle is in, and pushes
    CAPTURE(e, state.get<event::Count>(e), norm(state.get<needle::Force>(e)));
    CHECK(norm(state.get<needle::Force>(e)) > 1.0f);
    CHECK(state.get<event::Count>(e) >= 1);
  }
  for (auto const& law : batch_laws<Suturing, float>(c)) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

namespace {
using Driven = Simulation<Suturing, Serial, float>;

// A fresh run with the state of another, whose work memory has seen nothing of it.
Driven resumed(Driven const& from) {
  Driven fresh(from.options());
  fresh.restore(from.state());
  return fresh;
}
void check_same_ahead(Driven& changed, Driven& fresh, double h) {
  for (int s = 0; s < 3; ++s) {
    changed.step(h);
    fresh.step(h);
  }
  CHECK(changed.status(0) == fresh.status(0));
  CHECK(testing::same_bits(changed.state(), 0, fresh.state(), 0));
}
Driven stepped(testing::BatchProbe<Suturing, float, Drive> const& probe,
               testing::BatchCase<Drive> const& c, int steps) {
  auto run = probe.make({1});
  for (int s = 0; s < steps; ++s) run.step(c.step);
  return run;
}
}  // namespace

// Set halfway, in contact: what the old values left behind may be state, and nothing else.
TEST_CASE("friction that changes in contact is that of a fresh build", "[scene][B44]") {
  auto const c = driven(1);
  testing::BatchProbe<Suturing, float, Drive> const probe(c);
  for (double const mu : {0.0, 0.45}) {
    auto run = stepped(probe, c, 12);
    REQUIRE(norm(run.state().get<needle::Force>(0)) > 1.0f);
    auto unchanged = run;
    auto fresh = resumed(run);
    for (auto* r : {&fresh, &run}) r->set<Friction>({mu, small_config().contact.clamp_pressure});
    check_same_ahead(run, fresh, c.step);
    for (int s = 0; s < 3; ++s) unchanged.step(c.step);
    CHECK_FALSE(testing::same_bits(run.state(), 0, unchanged.state(), 0));
  }
}
TEST_CASE("a needle taken out and put back leaves nothing behind", "[scene][B44]") {
  auto const c = driven(1);
  testing::BatchProbe<Suturing, float, Drive> const probe(c);
  auto run = stepped(probe, c, 12);
  auto const view = run.state().view<Needles>();
  auto const pose = needle::pose(view, 0);
  auto const twist = needle::twist(view, 0);
  for (std::int64_t const needles : {0, 1}) {
    auto fresh = resumed(run);
    for (auto* r : {&fresh, &run}) {
      r->state().table<Needles>().set_live(0, needles);
      if (needles == 0) continue;
      needle::set_pose(r->state().view<Needles>(), 0, pose);
      needle::set_twist(r->state().view<Needles>(), 0, twist);
    }
    check_same_ahead(run, fresh, c.step);
    CHECK(run.status(0) == 0);
  }
}

TEST_CASE("a suturing scene in contact goes on from a file bit for bit", "[scene][checkpoint]") {
  auto const c = driven(12);
  testing::BatchProbe<Suturing, double, Drive> const probe(c);
  auto run = probe.make({0, 1});
  probe.advance(run);
  REQUIRE(norm(run.state().get<needle::Force>(0)) > 1.0);
  ::Scratch const folder;
  write_state_file((folder / "contact.state").string(), run.state());
  // Another simulation, whose work memory has seen nothing of the first.
  auto options = c.options;
  options.environments = 2;
  Simulation<Suturing, Serial, double> other(options);
  other.restore(read_state_file<decltype(run)::Store>((folder / "contact.state").string()));
  for (int s = 0; s < 3; ++s) {
    run.step(c.step);
    other.step(c.step);
    for (int e = 0; e < 2; ++e) CHECK(testing::same_bits(run.state(), e, other.state(), e));
  }
}

// So it does in another place of a larger batch, beside others.
TEST_CASE("a suturing environment in contact goes on in another slot", "[scene][checkpoint][B40]") {
  auto const c = driven(12);
  testing::BatchProbe<Suturing, float, Drive> const probe(c);
  auto run = probe.run({0, 1});
  REQUIRE(norm(run.state().get<needle::Force>(1)) > 1.0f);
  ::Scratch const folder;
  auto const file = (folder / "contact.state").string();
  write_state_file(file, run.state());
  auto batch = probe.make({3, 2, 3, 2});
  batch.step(c.step);
  batch.state().copy_environment(2, read_state_file<decltype(run)::Store>(file), 1);
  for (int s = 0; s < 3; ++s) {
    run.step(c.step);
    batch.step(c.step);
  }
  CHECK(testing::same_bits(run.state(), 1, batch.state(), 2));
  CHECK(batch.status(2) == run.status(1));
}

TEST_CASE("a suturing environment that blows up leaves the others alone", "[scene][batch]") {
  testing::BatchProbe<Suturing, float, Drive> const probe(driven(6));
  CHECK(probe.contained(Fault::not_finite, [](auto& r) {
    r.state().template set<particle::Velocity>(
        1, 5, vec(std::numeric_limits<float>::infinity(), 0.0f, 0.0f));
  }) == 0.0);
}

TEST_CASE("a bead or a needle that is nowhere freezes its environment and no other",
          "[scene][batch][B41]") {
  testing::BatchProbe<Suturing, float, Drive> const probe(driven(2));
  float const nan = std::numeric_limits<float>::quiet_NaN();
  auto const frozen = [&](auto&& spoil) {
    auto r = probe.make({0, 1, 2, 3});
    spoil(r.state());
    auto const before = r.state();
    probe.advance(r);
    CHECK(has(r.status(1), Fault::not_finite));
    CHECK(probe.different(r, {0, -1, 2, 3}) == 0.0);
    // Nothing of it has moved, so the tissue is still fit to be looked at.
    for (std::int64_t p = 0; p < 20; ++p)
      CHECK(r.state().template get<particle::Position>(1, p) ==
            before.template get<particle::Position>(1, p));
  };
  frozen([&](auto& s) { s.template set<bead::Position>(1, 4, vec(nan, 0.0f, 0.0f)); });
  frozen([&](auto& s) { s.template set<bead::Velocity>(1, 4, vec(0.0f, 1 / 0.0f, 0.0f)); });
  frozen([&](auto& s) { s.template set<needle::Position>(1, vec(0.0f, 0.0f, nan)); });
  frozen([&](auto& s) { s.template set<needle::Orientation>(1, {{nan, 0.0f, 0.0f, 0.0f}}); });
  frozen([&](auto& s) { s.template set<needle::AngularVelocity>(1, vec(nan, 0.0f, 0.0f)); });
}

TEST_CASE("effects after the solve act in a coupled scene too", "[scene][effect]") {
  auto const c = driven(3);
  Simulation<Counted, Serial, double> run(c.options);
  Drive{}(run, 0, 0);
  auto const end = run.state().get<bead::Position>(0, 19);
  for (int s = 0; s < 3; ++s) run.step(c.step);
  double const travelled = run.state().get<Travelled>(0, 19);  // of the bead tied to the needle
  CHECK(travelled == Approx(norm(run.state().get<bead::Position>(0, 19) - end)).epsilon(0.05));
  CHECK(travelled > 0.01);
}
