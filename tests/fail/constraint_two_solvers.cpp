// expect: mpmpbd Pbd<...>: more than one solver given; keep one of them, for example Xpbd<8>
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/solvers/jacobi.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
struct Suture : Pbd<Constraints<Distance>, Jacobi<20>> {};
#else
struct Suture : Pbd<Constraints<Distance>, Xpbd<8>, Jacobi<20>> {};
#endif

int main() { return Suture::substeps - 1; }
