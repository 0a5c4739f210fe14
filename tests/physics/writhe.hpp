// The writhe of a polyline.
#pragma once

#include <cmath>
#include <vector>

#include <mpmpbd/core/matrix.hpp>

namespace rods {

// The part of two segments a1-a2 and b1-b2 in the writhe, in turns: the signed area of directions in which they cross,
// over 2 pi (Klenin and Langowski 2000, method 1a).
inline double writhe_of_pair(mpmpbd::Vec3<double> const& a1, mpmpbd::Vec3<double> const& a2,
                             mpmpbd::Vec3<double> const& b1, mpmpbd::Vec3<double> const& b2) {
  using namespace mpmpbd;
  auto const r13 = b1 - a1, r14 = b2 - a1, r23 = b1 - a2, r24 = b2 - a2;
  Vec3<double> const n[4] = {direction(cross(r13, r14)), direction(cross(r14, r24)),
                             direction(cross(r24, r23)), direction(cross(r23, r13))};
  double area = 0;
  for (int i = 0; i < 4; ++i) area += std::asin(clamp(dot(n[i], n[(i + 1) % 4]), -1.0, 1.0));
  double const side = dot(cross(b2 - b1, a2 - a1), r13);
  return (side > 0 ? area : side < 0 ? -area : 0.0) / (2 * pi<double>);
}

inline double writhe(std::vector<mpmpbd::Vec3<double>> const& points) {
  double sum = 0;
  for (std::size_t i = 1; i + 2 < points.size(); ++i)
    for (std::size_t j = i + 2; j < points.size(); ++j)
      sum += writhe_of_pair(points[i - 1], points[i], points[j - 1], points[j]);
  return sum;
}

}  // namespace rods
