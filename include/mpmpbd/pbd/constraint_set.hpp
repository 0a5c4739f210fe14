// The kinds of constraints of a rod.
#pragma once

#include <mpmpbd/pbd/fields.hpp>

namespace mpmpbd {

// Constraints<Distance, Bend>: solved in the order in which they are written.
template <class... Cs> struct Constraints {
  using Role = role::ConstraintSet;
  static constexpr FixedString name = "constraints";
  static_assert(
      sizeof...(Cs) > 0,
      "mpmpbd Constraints<>: names no constraint; add one, for example Constraints<Distance>");
  static_assert((check_constraint<Cs>() && ... && true));

  using List = TypeList<Cs...>;
  using InstanceFields = union_t<typename instance<Cs>::List...>;
  template <class C> static constexpr bool has = (std::is_same_v<C, Cs> || ...);
  static constexpr bool has_frames = ((frame_count<Cs> > 0) || ...);
};

}  // namespace mpmpbd
