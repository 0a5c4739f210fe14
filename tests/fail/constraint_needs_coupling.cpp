// expect: mpmpbd Pbd<...>: a constraint acts on the needle or on tissue, which the rod's solver cannot move; add a coupling that takes it
#include <mpmpbd/core/state.hpp>
#include <mpmpbd/coupling/team.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/constraints/swage.hpp>

using namespace mpmpbd;

struct Suture : Pbd<Constraints<Distance, Swage>, Xpbd<8>> {};

#ifdef MPMPBD_FIXED
using Taken = TypeList<Swage>;  // what a coupling's Takes says
#else
using Taken = TypeList<>;
#endif

int main() {
  using Store = State<float, Suture::AllFields>;
  Store store(1);
  auto const env = access_environment(store, 0, Store::Domains{});
  return static_cast<int>(Suture::solve<Taken>(Solo{}, env, Tick<float>{0.001f, 0.001f, 0}));
}
