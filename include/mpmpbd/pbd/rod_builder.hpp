// Threads from a line and a material.
#pragma once

#include <cmath>
#include <span>

#include <mpmpbd/pbd/assembly.hpp>
#include <mpmpbd/pbd/constraints/bend.hpp>
#include <mpmpbd/pbd/constraints/bend_twist.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/constraints/stretch_shear.hpp>
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

// The lengths between points [m]; refuses what has none.
inline std::vector<double> segment_lengths(std::span<Vec3<double> const> points) {
  if (points.size() < 2)
    refuse_thread("beads = " + std::to_string(points.size()) + "; give at least 2");
  std::vector<double> length;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length.push_back(chord(points[i - 1], points[i]));
    if (!(length.back() > 0.0) || !std::isfinite(length.back()))
      refuse_thread("length of segment " + std::to_string(i - 1) + " = " +
                    std::to_string(length.back()) + " m; give a positive length");
  }
  return length;
}
// The length that bead i stands for: half of each adjacent segment.
inline double share_of(std::vector<double> const& length, std::size_t i) {
  return 0.5 * ((i > 0 ? length[i - 1] : 0.0) + (i < length.size() ? length[i] : 0.0));
}
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
  auto const length = detail::segment_lengths(points);
  auto share = [&](std::size_t i) { return detail::share_of(length, i); };

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

// Frames along a polyline: d3 of each along its segment, carried from one to the next without twist, d1 of the first
// one next to `up` (any direction across it when `up` is zero).
inline std::vector<Quaternion<double>> frames_along(std::span<Vec3<double> const> points,
                                                    Vec3<double> const& up = {}) {
  std::vector<Quaternion<double>> frames;
  Vec3<double> before{}, d1{};
  for (std::size_t i = 1; i < points.size(); ++i) {
    auto const d3 = direction(points[i] - points[i - 1]);
    if (i == 1) {
      d1 = direction(up - dot(up, d3) * d3);
      if (!(norm(d1) > 0.5)) d1 = any_across(d3);
    } else {  // by the shortest rotation from the last direction to this one; a fold turns about d1
      double const c = 1 + dot(before, d3);
      if (c > 1e-12) d1 -= dot(d1, d3) / c * (before + d3);
      d1 = direction(d1 - dot(d1, d3) * d3);
    }
    frames.push_back(quaternion::from_axes(d1, cross(d3, d1), d3));
    before = d3;
  }
  return frames;
}

// The beads and the frames of a thread: segment i has frame first_frame + i.
struct FramedRange : ThreadRange {
  std::int64_t first_frame;
};

// Adds a thread whose segments have frames: beads as add_thread does, the given frames, StretchShear per segment and
// BendTwist per joint with the compliances of the material. `as_placed` keeps bends and twists of the start. Throws
// std::invalid_argument naming what is wrong; nothing is added then.
template <class Body>
FramedRange add_framed_thread(RodAssembly<Body>& rod, std::span<Vec3<double> const> points,
                              std::span<Quaternion<double> const> frames,
                              RodMaterial const& material, RestShape rest = RestShape::straight) {
  material.check();
  auto const length = detail::segment_lengths(points);
  if (frames.size() != length.size())
    detail::refuse_thread("frames = " + std::to_string(frames.size()) + " for " +
                          std::to_string(length.size()) + " segments; give one for each");
  for (auto const& q : frames) quaternion::checked("add_thread, frames", q);
  std::int64_t const bead = rod.beads(), frame = rod.frames();
  for (std::size_t i = 0; i < points.size(); ++i)
    rod.add_bead(points[i], material.line_density() * detail::share_of(length, i));
  for (std::size_t i = 0; i < length.size(); ++i) {
    auto const s = static_cast<std::int64_t>(i);
    rod.add_frame(frames[i], material.axial_inertia(length[i]));
    rod.template add<StretchShear>(
        {bead + s, bead + s + 1, frame + s},
        {length[i], material.stretch_compliance(length[i]), material.shear_compliance(length[i])});
    if (i == 0) continue;
    double const l = detail::share_of(length, i);
    BendTwist::Parameters<double> k{0, 0, 0, material.bend_compliance(l),
                                    material.twist_compliance(l)};
    if (rest == RestShape::as_placed) {
      ValuesOf<BendTwist, double> x;
      get<0>(x) = frames[i - 1], get<1>(x) = frames[i];
      auto const now = BendTwist::evaluate(x, k).value;
      k.rest_bend_1 = now[0], k.rest_bend_2 = now[1], k.rest_twist = now[2];
    }
    rod.template add<BendTwist>({frame + s - 1, frame + s}, k);
  }
  return {{bead, rod.beads()}, frame};
}

// The same with frames that carry no twist.
template <class Body>
FramedRange add_framed_thread(RodAssembly<Body>& rod, std::span<Vec3<double> const> points,
                              RodMaterial const& material, RestShape rest = RestShape::straight) {
  auto const frames = frames_along(points);
  return add_framed_thread(rod, points, std::span<Quaternion<double> const>(frames), material,
                           rest);
}

}  // namespace mpmpbd
