// A surface that moves by more than a column within a step is met where it is.
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog.hpp>

#include "catch.hpp"
#include "coupling/moving_surface.hpp"

using namespace test;

TEMPLATE_TEST_CASE("a surface that changes columns within a step is seen in the new ones",
                   "[coupling][surface]", Serial, Threads) {
  using Run = Simulation<Suturing, TestType, float>;
  for (int substeps : {4, 8}) {
    CAPTURE(substeps);
    CHECK(met<Run>(0.44, substeps) == TipState::touch);
    CHECK(met<Run>(0.56, substeps) == TipState::outside);
  }
}
