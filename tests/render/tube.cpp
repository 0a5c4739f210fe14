#include <mpmpbd/render/tube.hpp>

#include "../catch.hpp"
#include "surface_checks.hpp"

using namespace mpmpbd;
using namespace mpmpbd::render;

namespace {

// Beads on a helix of radius 0.3 m and pitch 0.25 m.
std::vector<Vec3<float>> helix(int beads) {
  std::vector<Vec3<float>> line;
  for (int i = 0; i < beads; ++i) {
    float const a = 0.3f * float(i);
    line.push_back(vec(2.0f + 0.3f * cos(a), 0.3f * sin(a), 0.25f * a / (2.0f * pi<float>)));
  }
  return line;
}

// Half a circle of radius 0.32 m in the plane y = 0.
std::vector<Vec3<float>> half_circle() {
  std::vector<Vec3<float>> arc;
  for (int i = 0; i <= 36; ++i) {
    float const a = pi<float> * float(i) / 36.0f;
    arc.push_back(vec(0.32f * cos(a), 0.0f, 0.7f + 0.32f * sin(a)));
  }
  return arc;
}

float distance_to_line(std::vector<Vec3<float>> const& line, Vec3<float> const& p) {
  float nearest = 1e9f;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    Vec3<float> const d = line[i + 1] - line[i];
    float const s = clamp(dot(p - line[i], d) / dot(d, d), 0.0f, 1.0f);
    nearest = min(nearest, norm(p - line[i] - s * d));
  }
  return nearest;
}

}  // namespace

TEST_CASE("a tube of constant radius has all vertices at that radius from its centre line",
          "[render][tube]") {
  float const radius = 0.011f;
  std::vector<Vec3<float>> const beads = helix(20);
  Mesh const tube = TubeMaker{}.thread(beads, radius);
  std::vector<Vec3<float>> const line = smooth_line(beads, TubeResolution{}.per_segment);
  for (Vec3<float> const& p : tube.positions)
    CHECK_THAT(distance_to_line(line, p), WithinRel(radius, 2e-3f));
}

TEST_CASE("a thread passes through every bead and stays close to the curve they lie on",
          "[render][tube]") {
  std::vector<Vec3<float>> const beads = helix(20);
  std::vector<Vec3<float>> const line = smooth_line(beads, 6);
  for (std::size_t i = 0; i < beads.size(); ++i) CHECK(norm(line[6 * i] - beads[i]) < 1e-6f);
  // Away from the ends, where the curve is not known, the error of the spline is of third order.
  for (std::size_t i = 6; i + 7 < line.size(); ++i) {
    float const from_axis = norm(vec(line[i][0] - 2.0f, line[i][1], 0.0f));
    CHECK_THAT(from_axis, WithinAbs(0.3, 3e-4));
  }
}

TEST_CASE("thread and needle are watertight", "[render][tube]") {
  CHECK(watertight(TubeMaker{}.thread(helix(20), 0.011f)));
  CHECK(watertight(TubeMaker{}.needle(half_circle(), 0.02f, 0.12f)));
}

TEST_CASE("a straight thread has the volume of a cylinder with two half spheres",
          "[render][tube]") {
  std::vector<Vec3<float>> const beads = {vec(0.1f, 0.2f, 0.3f), vec(0.5f, 0.4f, 0.9f),
                                          vec(0.9f, 0.6f, 1.5f)};
  double const r = 0.05;
  double const length = double(norm(beads[2] - beads[0]));
  Mesh const tube =
      TubeMaker{}.thread(beads, float(r), {.sides = 96, .per_segment = 4, .cap_rings = 48});
  CHECK_THAT(volume(tube),
             WithinRel(pi<double> * r * r * length + 4.0 / 3.0 * pi<double> * r * r * r, 2e-3));
}

TEST_CASE("the tube does not turn about its line", "[render][tube]") {
  // In a plane curve every vertex of a ring keeps its height over the plane.
  TubeResolution const resolution{.sides = 8, .per_segment = 3, .cap_rings = 2};
  Mesh const tube = TubeMaker{}.thread(half_circle(), 0.02f, resolution);
  std::size_t const first = 8 * 2;  // after the cap
  for (std::size_t ring = 0; ring < 36 * 3; ++ring)
    for (std::size_t k = 0; k < 8; ++k)
      CHECK_THAT(tube.positions[first + 8 * ring + k][1],
                 WithinAbs(double(tube.positions[first + k][1]), 1e-5));
}

TEST_CASE("a needle ends in a point at its tip and is full wire before the taper",
          "[render][tube]") {
  std::vector<Vec3<float>> const arc = half_circle();
  float const radius = 0.02f;
  float const taper = 0.12f;
  Mesh const needle = TubeMaker{}.needle(arc, radius, taper);
  CHECK(norm(needle.positions.back() - arc.back()) < 1e-6f);
  for (Vec3<float> const& p : needle.positions) {
    float const distance = distance_to_line(arc, p);
    CHECK(distance < 1.02f * radius);
    float const to_tip = norm(p - arc.back());
    if (to_tip > taper + radius) CHECK_THAT(distance, WithinRel(radius, 2e-2f));
    if (to_tip < 0.25f * taper) CHECK(distance < 0.55f * radius);
  }
}

TEST_CASE("beads that coincide leave every vertex and normal finite", "[render][tube]") {
  Vec3<float> const p = vec(0.3f, -0.2f, 0.8f);
  std::vector<Vec3<float>> const beads = {p, p, vec(0.4f, -0.2f, 0.8f), vec(0.4f, -0.2f, 0.8f), p};
  Mesh const tube = TubeMaker{}.thread(beads, 0.01f);
  for (Vec3<float> const& x : tube.positions) CHECK(is_finite(x));
  for (Vec3<float> const& n : tube.normals) CHECK(is_finite(n));
  CHECK(TubeMaker{}.thread(std::vector{p}, 0.01f).triangles.empty());
}
