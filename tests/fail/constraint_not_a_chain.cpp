// expect: mpmpbd Pbd<...>: DirectBanded solves constraints between neighbours of a thread (Distance, Bend)
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/constraints/pin.hpp>
#include <mpmpbd/pbd/solvers/direct_banded.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
struct Suture : Pbd<Constraints<Distance>, DirectBanded<2>> {};
#else
struct Suture : Pbd<Constraints<Distance, Pin>, DirectBanded<2>> {};
#endif

int main() { return Suture::substeps - 1; }
