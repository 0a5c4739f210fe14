// expect: DirectFrames those of its frames (StretchShear, BendTwist); write Xpbd<8> or Jacobi<20> for the others
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/constraints/bend_twist.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/constraints/stretch_shear.hpp>
#include <mpmpbd/pbd/solvers/direct_frames.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
struct Suture : Pbd<Constraints<StretchShear, BendTwist>, DirectFrames<2>> {};
#else
struct Suture : Pbd<Constraints<Distance, BendTwist>, DirectFrames<2>> {};
#endif

int main() { return Suture::substeps - 1; }
