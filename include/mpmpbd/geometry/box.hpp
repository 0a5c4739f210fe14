// A box along the axes.
#pragma once

#include <stdexcept>
#include <string>

#include <mpmpbd/core/matrix.hpp>

namespace mpmpbd {

template <class T> struct Box {
  Vec3<T> low;
  Vec3<T> high;

  MPMPBD_HD constexpr Vec3<T> size() const { return high - low; }
  MPMPBD_HD constexpr Vec3<T> centre() const { return T(0.5) * (low + high); }
  MPMPBD_HD constexpr T volume() const { return size()[0] * size()[1] * size()[2]; }
  MPMPBD_HD constexpr bool contains(Vec3<T> const& x) const {
    for (int a = 0; a < 3; ++a)
      if (!(x[a] >= low[a] && x[a] <= high[a])) return false;
    return true;
  }
  // Positive outside, negative inside [m].
  MPMPBD_HD T distance(Vec3<T> const& x) const {
    Vec3<T> outside{};
    T inside = -(high[0] - low[0]);
    for (int a = 0; a < 3; ++a) {
      T const d = max(low[a] - x[a], x[a] - high[a]);
      outside[a] = max(d, T(0));
      inside = a == 0 ? d : max(inside, d);
    }
    T const far = norm(outside);
    return far > T(0) ? far : inside;
  }
};

template <class T> void check_box(Box<T> const& box, char const* owner = "Box") {
  for (int a = 0; a < 3; ++a) {
    if (is_finite(box.low[a]) && is_finite(box.high[a]) && box.high[a] > box.low[a]) continue;
    throw std::invalid_argument(
        "mpmpbd " + std::string(owner) + ": high[" + std::to_string(a) +
        "] = " + std::to_string(static_cast<double>(box.high[a])) + " m is not above low[" +
        std::to_string(a) + "] = " + std::to_string(static_cast<double>(box.low[a])) +
        " m; give two finite corners with positive extent along every axis");
  }
}

}  // namespace mpmpbd
