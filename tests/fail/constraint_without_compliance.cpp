// expect: mpmpbd Constraint: give its compliance alpha (energy C^2 / (2 alpha), 0 is rigid)
#include <mpmpbd/pbd/body.hpp>

using namespace mpmpbd;

struct Height {
  using Role = role::Constraint;
  static constexpr FixedString name = "Height";
  using Unknowns = TypeList<unknown::Point>;
  static constexpr int dimension = 1;
  static constexpr ConstraintKind kind = ConstraintKind::equality;
  template <class T> struct Parameters { T height, compliance; };
  static constexpr std::array<ParameterInfo, 2> parameter_info{
      {bound::any("height", "m"), bound::not_negative("compliance", "m/N")}};
  template <class X, class K> MPMPBD_HD static auto evaluate(X const& x, K const& k) {
    using T = typename X::Scalar;
    Evaluation<Height, T> e;
    e.value[0] = get<0>(x)[2] - k.height;
    gradient<0>(e) = {{T(0), T(0), T(1)}};
    return e;
  }
#ifdef MPMPBD_FIXED
  template <class T> MPMPBD_HD static T compliance(Parameters<T> const& k) { return k.compliance; }
#endif
};

struct Suture : Pbd<Constraints<Height>> {};

int main() { return Suture::substeps - 1; }
