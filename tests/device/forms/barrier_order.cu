// A block that meets as a resident one does, where racecheck can look at it alone, and reports nothing:
//   compute-sanitizer --tool racecheck test_device_barrier_order
// With any argument all meet at one barrier instead of two; then it reports races, of which there are none.
#include <vector>

#include <mpmpbd/backend/cuda/memory.cuh>

#include "device/barrier_order.cuh"
#include "device/report.hpp"

namespace {

using namespace mpmpbd;
using test::BarrierOrder;

constexpr int blocks = 132, threads = 512;

__global__ void __launch_bounds__(threads) meet(BarrierOrder order, unsigned* seen) {
  extern __shared__ unsigned grid[];
  auto const block = static_cast<int>(blockIdx.x);
  seen[block * threads + static_cast<int>(threadIdx.x)] = order.run(grid, block);
}

// How many threads have not seen what they should.
int wrong(BarrierOrder const& order) {
  cuda::Memory const memory(blocks * threads * sizeof(unsigned));
  cuda::start(nullptr, "a block", meet, blocks, threads,
              static_cast<std::size_t>(order.nodes) * sizeof(unsigned), order,
              memory.as<unsigned>());
  std::vector<unsigned> seen(blocks * threads);
  cuda::copy(nullptr, seen.data(), memory.as(), memory.bytes(), cudaMemcpyDeviceToHost);
  cuda::require(cudaStreamSynchronize(nullptr), "waiting");
  int count = 0;
  for (int block = 0; block < blocks; ++block) {
    auto const expected = order.expected(block);
    for (int t = 0; t < threads; ++t)
      count += seen[static_cast<std::size_t>(block * threads + t)] !=
               expected[static_cast<std::size_t>(t)];
  }
  return count;
}

}  // namespace

int main(int argc, char**) {
  for (int log2 : {8, 6}) {
    auto const found = wrong({threads, log2, 6400, 10, 20, argc == 1});
    test::check(found == 0, "all threads see what was written before they met", found);
  }
  return test::report.end();
}
