// The suturing task on an emulated device, beside the host's: what is shown, paid and drawn by lot is the same text.
#include <cmath>

#include "rl/suturing.hpp"  // before the device, whose words are macros that a TOML reader asks for

#include <mpmpbd/rl/cuda/episodes.cuh>
#include <mpmpbd/rl/cuda/vector_env.hpp>

#include "catch.hpp"
#include "cuda/fixed_point_noise.hpp"
#include "cuda/suturing.hpp"

using namespace mpmpbd;

namespace {

using rl::SuturingTask;

rl::SuturingTaskConfig settings() {
  rl::SuturingTaskConfig c;
  c.scene = test::config();
  c.episode = {.decision_interval = 2, .limit = 2, .frames = 2};
  return c;
}

// The largest difference of a group, in its unit, and its largest number.
template <class Group, class A, class B> std::pair<double, double> compare(A const& a, B const& b) {
  auto const x = a.template observation<Group>(), y = b.template observation<Group>();
  REQUIRE(x.size() == y.size());
  mpmpbd::testing::Worst worst;
  double most = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    worst.include(std::fabs(double(x[i]) - double(y[i])));
    most = std::max(most, std::fabs(double(y[i])));
  }
  return {worst.value(), most};
}
// How far fixed point moves tissue in three decisions [m].
double rounding(rl::SuturingTaskConfig const& c) {
  auto const& time = c.scene.time;
  double const steps = c.episode.decision_interval * 3;  // of what is looked at here
  return steps * time.step *
         test::fixed_point_noise(c.scene.domain.cell_size, time.step / time.substeps,
                                 time.substeps * steps);
}

}  // namespace

TEST_CASE("a stitch begins on a device as it does on the host", "[cuda][rl][suturing]") {
  auto const c = settings();
  double const x = rounding(c);
  rl::VectorEnvOptions const options{.num_envs = 2, .seed = 11};
  rl::VectorEnv<SuturingTask, Serial> host(c, options);
  rl::VectorEnv<SuturingTask, Cuda> device(c, options, Cuda{.threads = 128});
  std::vector<float> const actions{0.5f, -1.0f, 0.2f, 0.0f, 1.0f, -0.7f};
  for (int i = 0; i < 3; ++i) {  // over the end of an episode
    auto const& h = host.step(actions);
    auto const& d = device.step(actions);
    // The hand holds the needle: it goes where it is told, to the last bit where arithmetic is the host's.
    CHECK(compare<rl::NeedlePose>(device, host).first == 0.0);
    CHECK(compare<rl::NeedleTwist>(device, host).first == 0.0);
    CHECK(compare<rl::StitchState>(device, host).first == 0.0);
    CHECK(compare<rl::TipAndMarkers>(device, host).first < x);
    // A stiff thread makes force of tiny ways.
    auto const [tension, most] = compare<rl::ThreadTension>(device, host);
    CHECK(tension <= 1e-3 * most);
    CHECK(d.truncated == h.truncated);
    CHECK(d.status == h.status);
    CHECK(d.episode_length == h.episode_length);
    for (std::size_t k = 0; k < d.terms.size(); ++k)
      CHECK(std::fabs(double(d.terms[k]) - double(h.terms[k])) <= x * c.reward.entry_distance);
    CHECK(d.terms[0] < -0.1f);  // the way to the entry marker [m]
    CHECK(d.metrics == h.metrics);
  }
  CHECK(device.episode(1) == 2);
  auto const &a = std::as_const(device).simulation().state(),
             &b = std::as_const(host).simulation().state();
  for (std::int64_t env : {0, 1}) {  // the same were drawn
    CHECK(a.parameters<NeoHookean>(env).mu == b.parameters<NeoHookean>(env).mu);
    CHECK(a.parameters<Friction>(env).coefficient == b.parameters<Friction>(env).coefficient);
    CHECK(a.parameters<ArcNeedle>(env).radius == b.parameters<ArcNeedle>(env).radius);
  }
  CHECK(a.parameters<NeoHookean>(0).mu != a.parameters<NeoHookean>(1).mu);
}

TEST_CASE("the expert reads what a device shows, in the preset that the examples run",
          "[cuda][rl][suturing]") {
  auto const c = test::suturing_config("coarse.toml", {"episode.decision_interval=2"});
  rl::VectorEnvOptions const options{.num_envs = 2, .seed = 3};
  rl::VectorEnv<SuturingTask, Serial> host(c, options);
  rl::VectorEnv<SuturingTask, Cuda> device(c, options, Cuda{.threads = 128});
  rl::SuturingExperts on_host(host);
  rl::SuturingExperts on_device(device);
  // A marker that is seen elsewhere by this much is steered to within a decision.
  double const most = 2.0 * rounding(c) / (host.decision_time() * c.hand.speed);
  double moved = 0.0;
  for (int i = 0; i < 3; ++i) {
    auto const h = on_host.act(host), d = on_device.act(device);
    for (std::size_t k = 0; k < h.size(); ++k) {
      CHECK(std::fabs(double(h[k]) - double(d[k])) <= (i == 0 ? 0.0 : most));
      moved = std::max(moved, std::fabs(double(h[k])));
    }
    host.step(h);
    device.step(d);
  }
  CHECK(moved > 0.1);
  for (std::int64_t env : {0, 1}) {
    CHECK(device.decisions(env) == 3);
    CHECK(device.outcome().status[std::size_t(env)] == 0);
  }
}
