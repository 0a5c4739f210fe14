// expect: mpmpbd RodAssembly: no constraint of this rod acts on frames; write StretchShear and BendTwist into its Constraints<...>
#include <mpmpbd/pbd/rod_builder.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
struct Suture : Pbd<Constraints<StretchShear, BendTwist>, Xpbd<8>> {};
#else
struct Suture : Pbd<Constraints<Distance, Bend>, Xpbd<8>> {};
#endif

int main() {
  RodAssembly<Suture> rod;
  return static_cast<int>(rod.add_frame(quaternion::identity<double>(), 1e-9));
}
