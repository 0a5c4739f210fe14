// expect: mpmpbd Simulation<Scene, Cuda>: a stage after one of kind::ItemWise reads or writes nodes or particles, which are those of the next substep by then; put it before that stage
// A coupling that looks at the grid once its items have moved: a host has kept it, a device has gone on.
#include <mpmpbd/backend/cuda/together.cuh>

using namespace mpmpbd;

struct Items {
  using Kind = kind::ItemWise;
  using Reads = Fields<node::Velocity>;
  using Writes = Fields<>;
};
struct Last {
  using Kind = kind::Together;
#ifdef MPMPBD_FIXED
  using Reads = Fields<environment::Step>;
#else
  using Reads = Fields<node::Mass>;
#endif
  using Writes = Fields<>;
};

int main() { return cuda::detail::AtItemWise<TypeList<Items, Last>>::After::size == 1 ? 0 : 1; }
