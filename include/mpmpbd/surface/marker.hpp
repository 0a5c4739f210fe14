// Markers: material points of the tissue surface that a task names, for example entry and exit.
#pragma once

#include <mpmpbd/surface/queries.hpp>

namespace mpmpbd {

struct Markers {
  static constexpr FixedString name = "marker";
};

namespace marker {
struct Triangle : Field<"triangle", "1", Integer, Markers> {};
struct Weights : Field<"weights", "1", Numbers<2>, Markers> {};  // of the second and third corner

using State = Fields<Triangle, Weights>;

template <class View> MPMPBD_HD auto load(View const& view, std::int64_t item) {
  return SurfaceMark<typename View::Scalar>{view.template get<Triangle>(item),
                                            view.template get<Weights>(item)};
}
template <class View, class T>
MPMPBD_HD void store(View const& view, std::int64_t item, SurfaceMark<T> const& mark) {
  view.template set<Triangle>(item, mark.triangle);
  view.template set<Weights>(item, mark.weights);
}
}  // namespace marker

}  // namespace mpmpbd
