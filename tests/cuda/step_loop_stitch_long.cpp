// A whole stitch on an emulated device, made by the expert through what the step loop shows it: the same as on the host.
// seconds: 240
#include <cmath>

#include "rl/suturing.hpp"  // before the device, whose words are macros that a TOML reader asks for

#include <mpmpbd/rl/cuda/episodes.cuh>
#include <mpmpbd/rl/cuda/vector_env.hpp>

#include "catch.hpp"
#include "rl/sewn.hpp"

using namespace mpmpbd;

TEST_CASE("the expert sews on a device as it does on the host", "[cuda][rl][suturing]") {
  auto const c = test::suturing_config("coarse.toml");
  rl::VectorEnvOptions const options{.num_envs = 1, .autoreset = rl::Autoreset::disabled};
  auto const host = test::sew(rl::VectorEnv<rl::SuturingTask, Serial>(c, options));
  auto const device =
      test::sew(rl::VectorEnv<rl::SuturingTask, Cuda>(c, options, Cuda{.threads = 128}));
  REQUIRE(host.phase == std::int64_t(rl::StitchPhase::finished));
  CHECK(device.phase == host.phase);
  CHECK(device.decisions == host.decisions);
  CHECK(device.status == host.status);
  CHECK(device.events == host.events);
  CHECK(std::abs(device.entry_miss - host.entry_miss) < 0.01 * c.reach);
  CHECK(std::abs(device.exit_miss - host.exit_miss) < 0.01 * c.reach);
  // Not the thread's tension: at no more than 9 N, a strain of 3e-6, it is made of the rounding of positions in float.
  CHECK(device.force == Approx(host.force).epsilon(0.01));
}
