// A surface that moves by more than a column within a step is met where it is, on an emulated device too.
#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/catalog.hpp>

#include "catch.hpp"
#include "coupling/moving_surface.hpp"

using namespace test;

TEST_CASE("on a device a surface that changes columns within a step is seen in the new ones",
          "[cuda][surface]") {
  using Run = Simulation<Suturing, Cuda, float>;
  auto const form = GENERATE(Cuda::Execution::resident, Cuda::Execution::tiled);
  Cuda const where{.execution = form};
  for (int substeps : {4, 8}) {
    CAPTURE(substeps);
    CHECK(met<Run>(0.44, substeps, where) == TipState::touch);
    CHECK(met<Run>(0.56, substeps, where) == TipState::outside);
  }
}
