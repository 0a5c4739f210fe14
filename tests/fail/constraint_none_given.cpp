// expect: mpmpbd Pbd<...>: no constraints given; add them, for example Pbd<Constraints<Distance, Bend>>
// also: nvcc
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
struct Suture : Pbd<Constraints<Distance>, Xpbd<8>> {};
#else
struct Suture : Pbd<Xpbd<8>> {};
#endif

int main() { return Suture::substeps - 1; }
