// Threads from a line and a material.
#pragma once

#include <cmath>
#include <span>

#include <mpmpbd/pbd/assembly.hpp>
#include <mpmpbd/pbd/constraints/bend.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/rod_material.hpp>

namespace mpmpbd {

// The beads [first, last) of a thread within an environment.
struct ThreadRange {
  std::int64_t first;
  std::int64_t last;
  std::int64_t segments() const { return last - first - 1; }
};

enum class RestShape {
  straight,   // without load the thread is straight, however it lies at the start
  as_placed,  // without load it keeps the angles that it has at the start
};

namespace detail {
inline void refuse_thread(std::string const& sentence) {
  throw std::invalid_argument("mpmpbd add_thread: " + sentence);
}
inline double chord(Vec3<double> const& a, Vec3<double> const& b) { return norm(b - a); }
}  // namespace detail

// n points at equal distance along a polyline [m], ends included. Refuses fewer than 2 points and
// pieces without length.
inline std::vector<Vec3<double>> along(std::span<Vec3<double> const> line, int n) {
  if (line.size() < 2)
    detail::refuse_thread("points of the line = " + std::to_string(line.size()) +
                          "; give at least 2");
  if (n < 2) detail::refuse_thread("beads = " + std::to_string(n) + "; give at least 2");
  std::vector<double> reached{0.0};
  for (std::size_t i = 1; i < line.size(); ++i) {
    double const piece = detail::chord(line[i - 1], line[i]);
    if (!(piece > 0.0) || !std::isfinite(piece))
      detail::refuse_thread("length of piece " + std::to_string(i - 1) + " of the line = " +
                            std::to_string(piece) + " m; give a positive length");
    reached.push_back(reached.back() + piece);
  }
  std::vector<Vec3<double>> points;
  std::size_t i = 1;
  for (int k = 0; k < n; ++k) {
    double const s = reached.back() * k / (n - 1);
    while (i + 1 < line.size() && s > reached[i]) ++i;
    double const part = (s - reached[i - 1]) / (reached[i] - reached[i - 1]);
    points.push_back(k + 1 == n ? line.back() : line[i - 1] + part * (line[i] - line[i - 1]));
  }
  return points;
}

// Adds a thread whose beads are the given points [m], stress-free in length. A bead weighs half of each
// adjacent segment. Distance (compliance l/EA) and Bend (l/EI, l half of both segments) are added as far as the
// body has them. Throws std::invalid_argument naming what is wrong; nothing is added then.
template <class Body>
ThreadRange add_thread(RodAssembly<Body>& rod, std::span<Vec3<double> const> points,
                       RodMaterial const& material, RestShape rest = RestShape::straight) {
  material.check();
  auto const n = points.size();
  if (n < 2) detail::refuse_thread("beads = " + std::to_string(n) + "; give at least 2");
  std::vector<double> length;
  for (std::size_t i = 1; i < n; ++i) {
    length.push_back(detail::chord(points[i - 1], points[i]));
    if (!(length.back() > 0.0) || !std::isfinite(length.back()))
      detail::refuse_thread("length of segment " + std::to_string(i - 1) + " = " +
                            std::to_string(length.back()) + " m; give a positive length");
  }
  auto share = [&](std::size_t i) {
    return 0.5 * ((i > 0 ? length[i - 1] : 0.0) + (i + 1 < n ? length[i] : 0.0));
  };

  std::int64_t const first = rod.beads();
  auto number = [&](std::size_t i) { return first + static_cast<std::int64_t>(i); };
  for (std::size_t i = 0; i < n; ++i) rod.add_bead(points[i], material.line_density() * share(i));
  using Set = typename Body::Set;
  if constexpr (Set::template has<Distance>)
    for (std::size_t i = 0; i + 1 < n; ++i)
      rod.template add<Distance>({number(i), number(i + 1)},
                                 {length[i], material.stretch_compliance(length[i])});
  if constexpr (Set::template has<Bend>)
    for (std::size_t i = 1; i + 1 < n; ++i) {
      auto const d1 = points[i] - points[i - 1], d2 = points[i + 1] - points[i];
      double const turn =
          rest == RestShape::straight ? 0.0 : std::atan2(norm(cross(d1, d2)), dot(d1, d2));
      rod.template add<Bend>({number(i - 1), number(i), number(i + 1)},
                             {turn, material.bend_compliance(share(i))});
    }
  return {first, rod.beads()};
}

// The same with n beads at equal distance along a polyline.
template <class Body>
ThreadRange add_thread(RodAssembly<Body>& rod, std::span<Vec3<double> const> line, int beads,
                       RodMaterial const& material, RestShape rest = RestShape::straight) {
  material.check();
  auto const points = along(line, beads);
  return add_thread(rod, std::span<Vec3<double> const>(points), material, rest);
}

}  // namespace mpmpbd
