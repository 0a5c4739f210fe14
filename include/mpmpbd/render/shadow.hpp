// Soft shadows: the casters seen along a direction, as a blurred map of what they cover.
//
// One kind of map serves the shadow of the needle on the tissue (with the height of the caster, so
// that what is under the skin casts none), the shadow on the ground, and the darkness where things
// touch the ground (seen straight from above, blurred widely).
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <mpmpbd/render/mesh.hpp>
#include <mpmpbd/render/shading.hpp>

namespace mpmpbd::render {

// What a fragment needs to look its shadow up.
struct ShadowView {
  Vec3<float> across;   // unit, along the columns of the map
  Vec3<float> along;    // unit, along its rows
  Vec3<float> towards;  // unit, to the light
  float origin[2];      // of the map's corner along `across` and `along` [m]
  float per_metre;      // texels per metre
  int width, height;    // [texel]; 0: no casters
  float softness;       // height over which a shadow sets in under its caster [m]
  float const* cover;   // part of the light that is taken, (height, width)
  float const* top;     // height of the highest caster along `towards` [m], (height, width)
};

// Part of the light that the casters take from the point x [m], 0 to 1.
MPMPBD_HD inline float shadow(ShadowView const& map, Vec3<float> const& x) {
  float const u = (dot(map.across, x) - map.origin[0]) * map.per_metre - 0.5f;
  float const v = (dot(map.along, x) - map.origin[1]) * map.per_metre - 0.5f;
  if (!(u >= 0.0f && v >= 0.0f && u < float(map.width - 1) && v < float(map.height - 1)))
    return 0.0f;
  int const i = int(u);
  int const j = int(v);
  float const s = u - float(i);
  float const t = v - float(j);
  float const h = dot(map.towards, x);
  float taken = 0.0f;
  for (int corner = 0; corner < 4; ++corner) {
    int const di = corner & 1;
    int const dj = corner >> 1;
    int const at = (j + dj) * map.width + i + di;
    float const weight = (di ? s : 1.0f - s) * (dj ? t : 1.0f - t);
    if (map.cover[at] > 0.0f)
      taken += weight * map.cover[at] * clamp((map.top[at] - h) / map.softness, 0.0f, 1.0f);
  }
  return taken;
}

class ShadowMap {
 public:
  // Starts a map of `texels` along its longer side; `blur` is the radius of the penumbra [m].
  void start(std::span<Mesh const* const> casters, Vec3<float> const& towards, int texels,
             float blur) {
    view_ = {};
    view_.towards = towards;
    view_.across = unit(
        cross(towards, abs(towards[0]) < 0.8f ? vec(1.0f, 0.0f, 0.0f) : vec(0.0f, 1.0f, 0.0f)));
    view_.along = cross(towards, view_.across);
    if (!fit(casters, texels, blur)) return;
    for (Mesh const* mesh : casters)
      for (Triangle const& t : mesh->triangles) cast(*mesh, t);
    // Three box filters are a good Gaussian; casters keep their height as far as their blur reaches.
    int const radius = int(std::lround(blur * view_.per_metre / 1.7f));
    spread_top(3 * radius);
    for (int pass = 0; pass < 3; ++pass) box_filter(radius);
    view_.softness = max(blur, 1.0f / view_.per_metre);
    view_.cover = cover_.data();
    view_.top = top_.data();
  }

  ShadowView const& view() const { return view_; }

 private:
  static constexpr float nothing = -1e30f;

  int at(int i, int j) const { return j * view_.width + i; }

  bool fit(std::span<Mesh const* const> casters, int texels, float blur) {
    float low[2] = {1e30f, 1e30f};
    float high[2] = {-1e30f, -1e30f};
    for (Mesh const* mesh : casters)
      for (Vec3<float> const& x : mesh->positions) {
        if (!is_finite(x)) continue;
        float const p[2] = {dot(view_.across, x), dot(view_.along, x)};
        for (int a = 0; a < 2; ++a) {
          low[a] = min(low[a], p[a]);
          high[a] = max(high[a], p[a]);
        }
      }
    if (!(low[0] <= high[0])) return false;  // no casters
    float const longest = max(high[0] - low[0], high[1] - low[1]) + 6.0f * blur;
    if (!is_finite(longest)) return false;
    view_.per_metre = float(texels) / longest;
    for (int a = 0; a < 2; ++a) view_.origin[a] = low[a] - 3.0f * blur;
    view_.width = int((high[0] - low[0] + 6.0f * blur) * view_.per_metre) + 1;
    view_.height = int((high[1] - low[1] + 6.0f * blur) * view_.per_metre) + 1;
    // Its longer side has at most one texel more, so a map that moves never needs more than this.
    for (auto* texel : {&cover_, &top_, &scratch_})
      texel->reserve(static_cast<std::size_t>(texels + 1) * static_cast<std::size_t>(texels + 1));
    cover_.assign(at(0, view_.height), 0.0f);
    top_.assign(cover_.size(), nothing);
    scratch_.resize(cover_.size());
    return true;
  }

  // Marks the texels whose centres are under the triangle.
  void cast(Mesh const& mesh, Triangle const& t) {
    Vec3<float> p[3];
    for (int k = 0; k < 3; ++k) {
      Vec3<float> const& x = mesh.positions[t[k]];
      p[k] = vec((dot(view_.across, x) - view_.origin[0]) * view_.per_metre - 0.5f,
                 (dot(view_.along, x) - view_.origin[1]) * view_.per_metre - 0.5f,
                 dot(view_.towards, x));
    }
    auto const twice_area = [](Vec3<float> const& a, Vec3<float> const& b, float x, float y) {
      return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    };
    float const total = twice_area(p[0], p[1], p[2][0], p[2][1]);
    if (total == 0.0f || !is_finite(total)) return;
    auto const last = [](float bound, int size) { return min(int(bound), size - 1); };
    int const i0 = int(max(ceil(min(p[0][0], min(p[1][0], p[2][0]))), 0.0f));
    int const j0 = int(max(ceil(min(p[0][1], min(p[1][1], p[2][1]))), 0.0f));
    int const i1 = last(max(p[0][0], max(p[1][0], p[2][0])), view_.width);
    int const j1 = last(max(p[0][1], max(p[1][1], p[2][1])), view_.height);
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        float const a = twice_area(p[1], p[2], float(i), float(j)) / total;
        float const b = twice_area(p[2], p[0], float(i), float(j)) / total;
        float const c = 1.0f - a - b;
        if (a < 0.0f || b < 0.0f || c < 0.0f) continue;
        cover_[at(i, j)] = 1.0f;
        top_[at(i, j)] = max(top_[at(i, j)], a * p[0][2] + b * p[1][2] + c * p[2][2]);
      }
  }

  // The highest caster within `radius` texels, rows first, then columns.
  void spread_top(int radius) {
    auto const line = [&](int first, int step, int count) {
      for (int i = 0; i < count; ++i) {
        float highest = nothing;
        for (int k = max(i - radius, 0); k <= min(i + radius, count - 1); ++k)
          highest = max(highest, top_[first + k * step]);
        scratch_[i] = highest;
      }
      for (int i = 0; i < count; ++i) top_[first + i * step] = scratch_[i];
    };
    for (int j = 0; j < view_.height; ++j) line(at(0, j), 1, view_.width);
    for (int i = 0; i < view_.width; ++i) line(at(i, 0), at(0, 1), view_.height);
  }

  // The mean over 2 radius + 1 texels, rows first, then columns, as a running sum. Beyond the border
  // nothing is covered.
  void box_filter(int radius) {
    auto const line = [&](int first, int step, int count) {
      auto const value = [&](int i) {
        return i < 0 || i >= count ? 0.0f : cover_[first + i * step];
      };
      float sum = 0.0f;
      for (int i = -radius; i < radius; ++i) sum += value(i);
      for (int i = 0; i < count; ++i) {
        sum += value(i + radius);
        scratch_[i] = max(sum, 0.0f) / float(2 * radius + 1);
        sum -= value(i - radius);
      }
      for (int i = 0; i < count; ++i) cover_[first + i * step] = scratch_[i];
    };
    for (int j = 0; j < view_.height; ++j) line(at(0, j), 1, view_.width);
    for (int i = 0; i < view_.width; ++i) line(at(i, 0), at(0, 1), view_.height);
  }

  ShadowView view_{};
  std::vector<float> cover_{};
  std::vector<float> top_{};
  std::vector<float> scratch_{};
};

}  // namespace mpmpbd::render
