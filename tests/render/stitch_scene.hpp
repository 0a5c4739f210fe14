// A picture of suturing without any simulation: a tissue block dimpled where a half-circle needle has
// gone in and raised where it came out, with a thread behind it. Lengths of the preset `paper`.
#pragma once

#include <vector>

#include <mpmpbd/render/rasteriser.hpp>
#include <mpmpbd/render/tube.hpp>

namespace stitch_scene {

using mpmpbd::vec;
using mpmpbd::Vec3;
namespace render = mpmpbd::render;

struct Scene {
  render::Mesh tissue{};
  render::Mesh needle{};
  render::Mesh thread{};
  std::vector<render::Marker> markers{};
  float grid = 0.0f;  // [m]
  Vec3<float> low = vec(-1.0f, -0.5f, 0.0f);
  Vec3<float> high = vec(1.0f, 0.5f, 1.0f);

  std::vector<render::Object> objects() const {
    render::Finish skin = render::tissue(1.0f);
    skin.grid = grid;
    return {{&tissue, skin, markers}, {&needle, render::steel()}, {&thread, render::suture()}};
  }
};

// On the needle's circle in the plane y = 0; 200 degrees is the entry, 340 the exit.
inline Vec3<float> on_arc(float degrees) {
  float const a = degrees * mpmpbd::pi<float> / 180.0f;
  return vec(0.32f * mpmpbd::cos(a), 0.0f, 1.11f + 0.32f * mpmpbd::sin(a));
}

// Height that a push or pull of `height` [m] at x = `where` adds to the surface.
inline float bump(Vec3<float> const& x, float where, float height) {
  float const r2 = mpmpbd::square(x[0] - where) + mpmpbd::square(x[1]);
  return height * mpmpbd::exp(-r2 / 0.012f) * x[2] * x[2];
}

inline Scene make(float tip_degrees = 395.0f) {
  Scene scene;
  scene.tissue = render::box_surface(scene.low, scene.high, {{48, 24, 24}}, 0.06f);
  for (Vec3<float>& x : scene.tissue.positions)
    x[2] += bump(x, -0.3f, -0.06f) + bump(x, 0.3f, 0.035f);
  render::compute_normals(scene.tissue);
  scene.markers = {{vec(-0.3f, 0.0f, 1.0f), 0.0375f, vec(0.02f, 0.22f, 0.12f)},
                   {vec(0.3f, 0.0f, 1.0f), 0.0375f, vec(0.03f, 0.10f, 0.42f)}};

  std::vector<Vec3<float>> arc;
  for (float a = -180.0f; a <= 0.0f; a += 4.0f) arc.push_back(on_arc(tip_degrees + a));
  scene.needle = render::TubeMaker{}.needle(arc, 0.02f, 0.12f);

  // From the swage back through the tissue to the entry, then in a bow down onto the surface.
  std::vector<Vec3<float>> beads;
  for (float a = tip_degrees - 180.0f; a > 196.0f; a -= 12.0f) beads.push_back(on_arc(a));
  Vec3<float> const bow[] = {
      vec(-0.32f, -0.01f, 1.06f),  vec(-0.38f, -0.04f, 1.16f), vec(-0.48f, -0.09f, 1.19f),
      vec(-0.58f, -0.13f, 1.13f),  vec(-0.66f, -0.14f, 1.05f), vec(-0.74f, -0.12f, 1.015f),
      vec(-0.82f, -0.06f, 1.012f), vec(-0.86f, 0.03f, 1.012f), vec(-0.82f, 0.12f, 1.012f),
      vec(-0.73f, 0.17f, 1.012f),  vec(-0.63f, 0.17f, 1.012f), vec(-0.54f, 0.14f, 1.012f),
      vec(-0.45f, 0.15f, 1.012f),  vec(-0.37f, 0.19f, 1.012f)};
  beads.insert(beads.end(), std::begin(bow), std::end(bow));
  scene.thread = render::TubeMaker{}.thread(beads, 0.011f);
  return scene;
}

// From the front and well above, closer than the whole block.
inline Vec3<float> const view_side = vec(0.22f, -1.0f, 0.78f);

inline render::Camera camera(int width, int height) {
  return render::frame_box(vec(-0.85f, -0.5f, 0.62f), vec(0.85f, 0.5f, 1.3f), view_side,
                           vec(0.0f, 0.0f, 1.0f), width, height);
}

inline render::Studio studio(Scene const& scene) {
  return render::studio(scene.low, scene.high, view_side, vec(0.0f, 0.0f, 1.0f));
}

}  // namespace stitch_scene
