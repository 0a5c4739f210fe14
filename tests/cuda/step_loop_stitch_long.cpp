// A whole stitch on an emulated device, made by the expert through what the step loop shows it: the same as on the host.
// seconds: 240
#include <cmath>

#include "rl/suturing.hpp"  // before the device, whose words are macros that a TOML reader asks for

#include <mpmpbd/rl/cuda/episodes.cuh>
#include <mpmpbd/rl/cuda/vector_env.hpp>

#include "catch.hpp"

using namespace mpmpbd;

namespace {

struct Stitch {
  int decisions;
  std::int64_t phase;
  double entry_miss, exit_miss;  // [m]
  double force;                  // the largest on the needle [N]
  std::uint32_t status;
};

template <class Envs> Stitch sew(Envs&& envs) {
  rl::SuturingExperts experts(envs);
  Stitch stitch{};
  while (!envs.waits(0)) {
    envs.step(experts.act(envs));
    auto const wrench = envs.template newest<rl::NeedleWrench>(0);
    stitch.force =
        std::max(stitch.force, std::hypot(double(wrench[0]), double(wrench[1]), double(wrench[2])));
  }
  auto const& out = envs.outcome();
  stitch.decisions = out.episode_length[0];
  stitch.phase = std::int64_t(envs.template metric<rl::metric::Phase>(0));
  stitch.entry_miss = double(envs.template metric<rl::metric::EntryMiss>(0));
  stitch.exit_miss = double(envs.template metric<rl::metric::ExitMiss>(0));
  stitch.status = out.status[0];
  return stitch;
}

}  // namespace

TEST_CASE("the expert sews on a device as it does on the host", "[cuda][rl][suturing]") {
  auto const c = test::suturing_config("coarse.toml");
  rl::VectorEnvOptions const options{.num_envs = 1, .autoreset = rl::Autoreset::disabled};
  auto const host = sew(rl::VectorEnv<rl::SuturingTask, Serial>(c, options));
  auto const device = sew(rl::VectorEnv<rl::SuturingTask, Cuda>(c, options, Cuda{.threads = 128}));
  REQUIRE(host.phase == std::int64_t(rl::StitchPhase::finished));
  CHECK(device.phase == host.phase);
  CHECK(device.decisions == host.decisions);
  CHECK(device.status == host.status);
  CHECK(std::abs(device.entry_miss - host.entry_miss) < 0.01 * c.reach);
  CHECK(std::abs(device.exit_miss - host.exit_miss) < 0.01 * c.reach);
  // Not the thread's tension: at no more than 9 N, a strain of 3e-6, it is made of the rounding of positions in float.
  CHECK(device.force == Approx(host.force).epsilon(0.01));
}
