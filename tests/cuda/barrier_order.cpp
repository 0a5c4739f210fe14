// The program on which racecheck can be tried (tests/device/forms/barrier_order.cu), on an emulated device: under the
// thread sanitizer it has no race.
#include "catch.hpp"

#include "device/barrier_order.cuh"

TEST_CASE("a block meets in the order of a resident one", "[cuda][team]") {
  for (int log2 : {5, 6})
    for (int block : {0, 1})
      for (bool twice : {false, true}) {
        test::BarrierOrder const order{128, log2, 640, 3, 4, twice};
        std::vector<unsigned> grid(640), seen(128);
        blockDim = dim3(128);
        emulated::Block(128, [&] { seen[threadIdx.x] = order.run(grid.data(), block); }).run();
        CHECK(seen == order.expected(block));
      }
}
