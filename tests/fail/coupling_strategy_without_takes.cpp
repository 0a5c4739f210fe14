// expect: mpmpbd Coupling<Strategy, ...>: a strategy gives a name, `using Takes = TypeList<...>` of the constraints it solves itself
#include <mpmpbd/coupling/embedded.hpp>

using namespace mpmpbd;

struct Glue {
  static constexpr FixedString name = "glue";
#ifdef MPMPBD_FIXED
  using Takes = TypeList<>;
#endif
  static constexpr Conserves conserves = Conserves::none;
  template <class In> using Stages = FollowTissue<In>;
};
using Laws = Coupling<Glue>;

int main() { return Laws::FrictionLaw::grips ? 1 : 0; }
