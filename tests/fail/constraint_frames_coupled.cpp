// expect: mpmpbd Pbd<...>: a coupling moves beads, not the frames of segments (StretchShear, BendTwist)
#include <mpmpbd/core/state.hpp>
#include <mpmpbd/coupling/team.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>

using namespace mpmpbd;

#ifdef MPMPBD_FIXED
struct Suture : Pbd<Constraints<Distance, Bend>, Xpbd<8>> {};
#else
struct Suture : Pbd<Constraints<StretchShear, BendTwist>, Xpbd<8>> {};
#endif

int main() {
  using Store = State<float, Suture::AllFields>;
  Store store(1);
  auto const env = access_environment(store, 0, Store::Domains{});
  // What a coupling calls that moves the beads itself.
  return static_cast<int>(Suture::finish_as_velocity(Solo{}, env, Tick<float>{0.001f, 0.001f, 0}));
}
