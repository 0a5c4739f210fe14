// expect: mpmpbd Simulation<Scene, Cuda>: a stage of kind::ItemWise names fields of particles or writes nodes, while particles gather from them; leave that to a stage of kind::Together before it
// Items that push the nodes of the grid: on a device particles take velocities from them meanwhile.
#include <mpmpbd/backend/cuda/together.cuh>

using namespace mpmpbd;

struct Items {
  using Kind = kind::ItemWise;
  using Reads = Fields<node::Velocity>;
#ifdef MPMPBD_FIXED
  using Writes = Fields<>;
#else
  using Writes = Fields<node::Velocity>;
#endif
};

int main() { return cuda::detail::AtItemWise<TypeList<Items>>::ItemWise::size == 1 ? 0 : 1; }
