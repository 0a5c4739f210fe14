// Tubes around a line: the thread, and the needle with its point.
//
// The frame is carried along the line without turning about it (rotation-minimising frame by double
// reflection; Wang, Juettler, Zheng and Liu, ACM Trans. Graph. 27(1), 2008), so the tube has no twist.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <mpmpbd/render/mesh.hpp>

namespace mpmpbd::render {

// How finely a tube is drawn.
struct TubeResolution {
  int sides = 14;       // vertices around
  int per_segment = 6;  // rings between two neighbouring beads
  int cap_rings = 4;    // rings of a round end
};

// One point of a centre line and the radius there [m].
struct TubePoint {
  Vec3<float> centre;
  float radius;
};

namespace detail {

// A point of the centripetal Catmull-Rom curve between b and c, 0 <= s <= 1 (Barry and Goldman's
// pyramid). Knots are square roots of the distances: no loops where beads are unevenly spaced.
inline Vec3<float> catmull_rom(Vec3<float> const (&p)[4], float s) {
  float spacing[3];
  for (int i = 0; i < 3; ++i) spacing[i] = sqrt(norm(p[i + 1] - p[i]));
  float const longest = max(spacing[0], max(spacing[1], spacing[2]));
  if (longest <= 0.0f) return p[1];
  float knot[4] =
      {};  // beads that coincide keep a little distance, so that nothing divides by zero
  for (int i = 0; i < 3; ++i) knot[i + 1] = knot[i] + max(spacing[i], 0.05f * longest);
  float const t = knot[1] + s * (knot[2] - knot[1]);
  Vec3<float> level[4] = {p[0], p[1], p[2], p[3]};
  for (int span = 1; span < 4; ++span)
    for (int i = 0; i + span < 4; ++i) {
      // The last level interpolates over the middle knots only.
      int const from = span == 3 ? 1 : i;
      int const to = span == 3 ? 2 : i + span;
      float const w = (t - knot[from]) / (knot[to] - knot[from]);
      level[i] = (1.0f - w) * level[i] + w * level[i + 1];
    }
  return level[0];
}

struct Frame {
  Vec3<float> tangent;
  Vec3<float> normal;
};

inline Vec3<float> any_normal(Vec3<float> const& tangent) {
  int smallest = 0;
  for (int i = 1; i < 3; ++i)
    if (abs(tangent[i]) < abs(tangent[smallest])) smallest = i;
  Vec3<float> axis{};
  axis[smallest] = 1.0f;
  return direction(cross(tangent, axis));
}

inline Vec3<float> reflect(Vec3<float> const& v, Vec3<float> const& across) {
  float const length2 = dot(across, across);
  return length2 > 0.0f ? v - (2.0f * dot(v, across) / length2) * across : v;
}

// The frame at the next point: reflected in the plane halfway between the points, then in the plane
// that brings the reflected tangent onto the next one.
inline Frame carry(Frame const& frame, Vec3<float> const& step, Vec3<float> const& next_tangent) {
  Vec3<float> const normal = reflect(frame.normal, step);
  Vec3<float> const tangent = reflect(frame.tangent, step);
  return {next_tangent, direction(reflect(normal, next_tangent - tangent))};
}

// A mesh that grows ring by ring along a line.
struct Sweep {
  Mesh& mesh;
  int sides;

  int vertices() const { return static_cast<int>(mesh.positions.size()); }

  // A ring of radius zero is left out: the pole takes its place.
  void ring(Vec3<float> const& centre, Frame const& frame, float radius) {
    if (radius <= 0.0f) return;
    int const b = vertices();
    int const a = b - sides;
    Vec3<float> const binormal = cross(frame.tangent, frame.normal);
    for (int k = 0; k < sides; ++k) {
      float const angle = 2.0f * pi<float> * float(k) / float(sides);
      mesh.positions.push_back(centre +
                               radius * (cos(angle) * frame.normal + sin(angle) * binormal));
    }
    for (int k = 0; k < sides && a >= 0; ++k) {
      int const next = (k + 1) % sides;
      mesh.triangles.push_back({{a + k, a + next, b + next}});
      mesh.triangles.push_back({{a + k, b + next, b + k}});
    }
  }

  // The rings of a half sphere without its pole; sense -1 before the first point, +1 after the last.
  void cap(TubePoint const& end, Frame const& frame, int sense, int rings) {
    for (int k = 1; k <= rings; ++k) {
      int const from_equator = sense < 0 ? rings + 1 - k : k;
      float const angle = 0.5f * pi<float> * float(from_equator) / float(rings + 1);
      ring(end.centre + (float(sense) * end.radius * sin(angle)) * frame.tangent, frame,
           end.radius * cos(angle));
    }
  }

  // Closes the tube over the ring that starts at vertex `first`.
  void pole(TubePoint const& end, Frame const& frame, int sense, int first) {
    int const top = vertices();
    mesh.positions.push_back(end.centre + (float(sense) * end.radius) * frame.tangent);
    for (int k = 0; k < sides; ++k) {
      int const here = first + k;
      int const next = first + (k + 1) % sides;
      mesh.triangles.push_back(sense < 0 ? Triangle{{top, next, here}}
                                         : Triangle{{top, here, next}});
    }
  }
};

inline Vec3<float> tangent_at(std::span<TubePoint const> points, std::size_t i) {
  std::size_t const from = i > 0 ? i - 1 : 0;
  std::size_t const to = i + 1 < points.size() ? i + 1 : i;
  return direction(points[to].centre - points[from].centre);
}

}  // namespace detail

// A smooth line through all beads [m], (point, 3), with `per_segment` pieces between two of them.
inline void smooth_line(std::span<Vec3<float> const> beads, int per_segment,
                        std::vector<Vec3<float>>& line) {
  std::size_t const n = beads.size();
  line.clear();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    // Beyond the ends the line goes on as its mirror image through the end bead.
    Vec3<float> const before = i > 0 ? beads[i - 1] : 2.0f * beads[0] - beads[1];
    Vec3<float> const after = i + 2 < n ? beads[i + 2] : 2.0f * beads[n - 1] - beads[n - 2];
    Vec3<float> const window[4] = {before, beads[i], beads[i + 1], after};
    for (int k = 0; k < per_segment; ++k)
      line.push_back(detail::catmull_rom(window, float(k) / float(per_segment)));
  }
  if (n > 0) line.push_back(beads[n - 1]);
}
inline std::vector<Vec3<float>> smooth_line(std::span<Vec3<float> const> beads, int per_segment) {
  std::vector<Vec3<float>> line;
  smooth_line(beads, per_segment, line);
  return line;
}

// The surface swept by a circle along the points, closed by half spheres; an end of radius zero
// closes in a point. Fewer than two points make an empty mesh.
inline void sweep(std::span<TubePoint const> points, TubeResolution const& resolution, Mesh& mesh) {
  mesh.positions.clear();
  mesh.normals.clear();
  mesh.triangles.clear();
  mesh.closed = points.size() >= 2;
  if (!mesh.closed) return;
  detail::Sweep tube{mesh, resolution.sides};
  Vec3<float> const first_tangent = detail::tangent_at(points, 0);
  detail::Frame const start{first_tangent, detail::any_normal(first_tangent)};
  detail::Frame frame = start;
  tube.cap(points.front(), frame, -1, resolution.cap_rings);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0)
      frame = detail::carry(frame, points[i].centre - points[i - 1].centre,
                            detail::tangent_at(points, i));
    tube.ring(points[i].centre, frame, points[i].radius);
  }
  tube.cap(points.back(), frame, +1, resolution.cap_rings);
  int const last_ring = tube.vertices() - tube.sides;
  tube.pole(points.front(), start, -1, 0);
  tube.pole(points.back(), frame, +1, last_ring);
  compute_normals(mesh);
}

// Makes tubes, one at a time; its memory is used again.
class TubeMaker {
 public:
  // The thread: a smooth tube of constant radius [m] through the beads [m], with round ends.
  Mesh const& thread(std::span<Vec3<float> const> beads, float radius,
                     TubeResolution const& resolution = {}) {
    smooth_line(beads, resolution.per_segment, line_);
    points_.clear();
    for (Vec3<float> const& p : line_) points_.push_back({p, radius});
    sweep(points_, resolution, mesh_);
    return mesh_;
  }
  // The needle: a tube of wire radius [m] along the points [m] of its arc, from the swage (first, round)
  // to the tip (last, pointed). The last `taper` [m] of the line narrow to the point.
  Mesh const& needle(std::span<Vec3<float> const> arc, float radius, float taper,
                     TubeResolution const& resolution = {
                         .sides = 20, .per_segment = 2, .cap_rings = 5}) {
    smooth_line(arc, resolution.per_segment, line_);
    points_.resize(line_.size());
    float to_tip = 0.0f;
    for (std::size_t i = line_.size(); i-- > 0;) {
      if (i + 1 < line_.size()) to_tip += norm(line_[i + 1] - line_[i]);
      float const s = taper > 0.0f ? min(to_tip / taper, 1.0f) : 1.0f;
      points_[i] = {line_[i], radius * s * (2.0f - s)};  // a parabola: smooth where the wire begins
    }
    if (!points_.empty()) points_.back().radius = 0.0f;
    sweep(points_, resolution, mesh_);
    return mesh_;
  }

 private:
  std::vector<Vec3<float>> line_{};
  std::vector<TubePoint> points_{};
  Mesh mesh_{};
};

}  // namespace mpmpbd::render
