// GridProjection composes: tissue with thread, needle or both, in batches with the same bits.
// seconds: 5
#include <mpmpbd/coupling/grid_projection.hpp>
#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/effects/walls.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/pbd/constraints/bend.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/testing/batch_laws.hpp>
#include <mpmpbd/testing/samples.hpp>

#include "catch.hpp"

using namespace mpmpbd;

namespace {

constexpr double dx = 2e-3;
struct Tissue : Mpm<NeoHookean> {};
struct Thread : Pbd<Constraints<Distance, Bend, Swage>> {};
using Floor = Wall<Sticky, 2, Side::low>;
struct Sewn : Scene<Tissue, Thread, ArcNeedle, Coupling<GridProjection, Friction>, Gravity, Floor> {
};
struct Pierced : Scene<Tissue, FreeArcNeedle, Coupling<GridProjection>, Floor> {};

// Nothing of the one that is not named: no needle in a scene of threads, no beads in one of a needle.
static_assert(on_t<Pierced::StateFields, Beads>::count == 0);
static_assert(on_t<Sewn::StateFields, ContactPoints>::count == 0);
static_assert(Sewn::Substep::Stages::size == 4 && Pierced::Substep::Stages::size == 4);

constexpr ArcNeedle::Parameters<double> arc{6e-3, 2.5, 2e-4, 1e-3, 0.0, 0.0};
constexpr int beads = 8;

// A needle half in tissue that turns about its centre and leads a heavy thread behind it.
struct Fill {
  template <class R> void operator()(R& run, std::int64_t env, int which) const {
    using T = typename R::Scalar;
    using S = typename R::Scene;
    run.template set<NeoHookean>(env, lame(2e4 * (1 + which), 0.4));
    run.template set<GridProjection>(env, {dx * (0.6 + 0.1 * which), 0.01});
    run.template set<Floor>(env, {3 * dx});
    std::vector<Vec3<double>> points;
    testing::Samples random(static_cast<std::uint64_t>(which) + 1);
    for (int k = 0; k < 10; ++k)
      for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 12; ++i)
          points.push_back(dx *
                           (vec(4.25, 5.25, 3.25) + 0.5 * vec(double(i), double(j), double(k)) +
                            random.matrix<3>(-0.05, 0.05)));
    run.add_particles(env, points, 1050.0, dx * dx * dx / 8);
    Pose<double> const pose{dx * vec(7.0, 7.5, 8.5),
                            quaternion::from_axis_angle(vec(1.0, 0.0, 0.0), 0.5 * pi<double>)};
    auto& state = run.state();
    state.template table<Needles>().set_live(env, 1);
    auto const view = state.template view<Needles>();
    std::int64_t const item = env * view.capacity;
    needle::set_pose(view, item, cast_pose<T>(pose));
    needle::set_twist(view, item, Twist<T>{{}, cast<T>((4.0 + which) * vec(0.0, 1.0, 0.0))});
    if constexpr (S::has_rods) {
      run.template set<Gravity>(env, {{0.0, 0.0, -9.81}});
      run.template set<Friction>(env, {0.1 * which, 0.0});
      run.template set<ArcNeedle>(env, arc);
      auto const end = swage_point(ArcNeedle::arc(arc), pose, Sweep<double>::of(pose, {}, 1e-4));
      std::vector<Vec3<double>> line;
      for (int b = 0; b < beads; ++b)
        line.push_back(end.position + (0.9 * dx * (beads - 1 - b)) * direction(vec(0.1, 0.3, 1.0)));
      thread(line).write(state, env);
    } else {
      run.template set<FreeArcNeedle>(
          env, {arc.radius, arc.angle, arc.wire_radius, arc.taper, 0.0, 0.0, 4e5});
    }
  }
  static RodAssembly<Thread> thread(std::vector<Vec3<double>> const& line) {
    RodAssembly<Thread> rod;
    add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{1e7, 2e-4, 4e4});
    rod.add<Swage>({beads - 1}, {arc.radius, 0.0, 0.0, 0.0});
    return rod;
  }
};

SimulationOptions options() {
  SimulationOptions o;
  o.cell_size = dx;
  for (int a = 0; a < 3; ++a) o.nodes[a] = a == 2 ? 20 : 17;
  std::vector<Vec3<double>> line;
  for (int b = 0; b < beads; ++b) line.push_back(dx * vec(double(b), 0.0, 0.0));
  o.capacity = Fill::thread(line).capacity();
  o.capacity.push_back({"particle", 1200});
  o.capacity.push_back({"needle", 1});
  return o;
}

}  // namespace

TEMPLATE_TEST_CASE("batches of tissue, thread and needle with GridProjection", "", float, double) {
  testing::BatchCase<Fill> const c{options(), Fill{}, 1e-3, 6};
  testing::BatchProbe<Sewn, TestType, Fill> const probe(c);
  for (int e = 0; e < 4; ++e) {
    auto& state =
        const_cast<typename Simulation<Sewn, Serial, TestType>::Store&>(probe.reference().state());
    CHECK(probe.reference().status(e) == 0);
    CHECK(norm(state.template get<needle::Force>(e)) > 0);
    CHECK(state.template get<needle::PeakForce>(e) > 0);
    // The tied bead is at the needle's end, and weighs what it did.
    auto const view = state.template view<Needles>();
    auto const pose = needle::pose(view, e * view.capacity);
    auto const end = to_world(
        pose,
        ArcNeedle::arc(cast_parameters<ArcNeedle, TestType, double>(arc)).point(TestType(15e-3)));
    CHECK(double(norm(state.template get<bead::Position>(e, beads - 1) - end)) < 1e-6);
    CHECK(state.template get<bead::InverseMass>(e, beads - 1) > 0);
  }
  for (auto const& law : batch_laws<Sewn, TestType>(c)) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

TEST_CASE("a free needle with GridProjection", "") {
  testing::BatchCase<Fill> const c{options(), Fill{}, 1e-3, 4};
  for (auto const& law : batch_laws<Pierced, double>(c)) {
    INFO(law.text());
    CHECK(law.holds());
  }
  testing::BatchProbe<Pierced, double, Fill> const probe(c);
  // The tissue slows it, one substep late.
  CHECK(probe.reference().status(0) == 0);
  CHECK(norm(probe.reference().state().get<needle::AngularVelocity>(0)) < 4.0);
}
