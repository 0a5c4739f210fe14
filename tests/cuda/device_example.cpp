// The code of docs/concepts/device.md, on an emulated device.
#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/catalog/suturing.hpp>

#include "catch.hpp"
#include "cuda/suturing.hpp"
#include "shown.hpp"

using namespace mpmpbd;

TEST_CASE("the page of devices shows code that runs", "[cuda][docs]") {
  auto const config = test::config();
  using Run = Simulation<Suturing, Cuda, float>;
  Run run(suturing::options(config, 2));
  for (std::int64_t env = 0; env < 2; ++env) suturing::set_up(run, env, config);
  run.remember();
  run.step(config.time.step);
  run.reset(std::vector<unsigned char>{0, 1});

  CHECK(run.status(0) == 0);
  auto const& state = std::as_const(run).state();
  CHECK(state.get<environment::Step>(0) == config.time.substeps);
  CHECK(state.get<environment::Step>(1) == 0);
  CHECK(blocks_not_in(__FILE__, "concepts/device.md") == std::vector<std::string>{});
}
