// Draws meshes into an image on the CPU, without a window system.
//
// First every triangle is sampled four times per pixel, keeping the nearest opaque and the nearest
// translucent one; then every pixel computes the light of what it kept, once per pair of triangles.
// Nothing depends on the order of threads or on the last frame: equal scenes give equal bytes.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <mpmpbd/render/image.hpp>
#include <mpmpbd/render/picture.hpp>

namespace mpmpbd::render {

// Something to draw. The mesh and the markers must outlive the drawing.
struct Object {
  Mesh const* mesh;
  Finish finish;
  std::span<Marker const> markers{};
};

class Rasteriser {
 public:
  // Draws the objects into the image, which takes the camera's size.
  void draw(Camera const& camera, Studio const& studio, std::span<Object const> objects,
            Image& image) {
    image.resize(camera.width, camera.height);
    collect(camera, objects);
    Picture picture{};
    picture.camera = camera;
    picture.studio = studio;
    picture.subjects = subjects_.data();
    picture.subject_count = int(subjects_.size());
    cast_shadows(picture, objects);
    opaque_.clear(image.pixels());
    veil_.clear(image.pixels());
    for (std::size_t k = 0; k < objects.size(); ++k) {
      Layer& layer = translucent(objects[k].finish) ? veil_ : opaque_;
      int const count = int(objects[k].mesh->triangles.size());
      for (int t = 0; t < count; ++t) sample(camera, subjects_[k], t, layer);
    }
    for (int row = 0; row < image.height; ++row)
      for (int column = 0; column < image.width; ++column) resolve(picture, column, row, image);
  }

 private:
  static constexpr int samples = 4;
  // Rotated grid: four different columns and rows, so that steep and flat edges get four levels.
  static constexpr float sample_column[samples] = {0.375f, 0.875f, 0.125f, 0.625f};
  static constexpr float sample_row[samples] = {0.125f, 0.375f, 0.625f, 0.875f};

  // The nearest triangle of every sample.
  struct Layer {
    std::vector<float> nearness{};  // 1/forward [1/m], (height, width, samples); 0: nothing
    std::vector<int> triangle{};    // (height, width, samples)

    void clear(std::size_t pixels) {
      nearness.assign(samples * pixels, 0.0f);
      triangle.assign(samples * pixels, none);
    }
  };

  // The objects as the pixels see them, with positions in view coordinates.
  void collect(Camera const& camera, std::span<Object const> objects) {
    std::size_t vertices = 0;
    for (Object const& object : objects) vertices += object.mesh->positions.size();
    view_.clear();
    view_.reserve(vertices);  // pointers into it are taken below
    subjects_.clear();
    int first = 0;
    for (Object const& object : objects) {
      Mesh const& mesh = *object.mesh;
      Vec3<float> const* const view = view_.data() + view_.size();
      for (Vec3<float> const& x : mesh.positions) view_.push_back(to_view(camera, x));
      subjects_.push_back(
          {.view = view,
           .normals = mesh.normals.data(),
           .material = mesh.material.empty() ? mesh.positions.data() : mesh.material.data(),
           .colours = mesh.colours.empty() ? nullptr : mesh.colours.data(),
           .triangles = mesh.triangles.data(),
           .markers = object.markers.data(),
           .marker_count = int(object.markers.size()),
           .closed = mesh.closed,
           .first = first,
           .finish = object.finish});
      first += int(mesh.triangles.size());
    }
  }

  void cast_shadows(Picture& picture, std::span<Object const> objects) {
    all_casters_.clear();
    opaque_casters_.clear();
    for (Object const& object : objects) {
      all_casters_.push_back(object.mesh);
      if (!translucent(object.finish)) opaque_casters_.push_back(object.mesh);
    }
    Studio const& s = picture.studio;
    // As fine as the picture, and no finer than its blur shows.
    int const texels = min(320, max(picture.camera.width, picture.camera.height));
    on_tissue_.start(opaque_casters_, s.key, texels, 0.006f * s.reach);
    picture.on_tissue = on_tissue_.view();
    if (!s.ground) return;
    on_ground_.start(all_casters_, s.key, 128, 0.05f * s.reach);
    picture.on_ground = on_ground_.view();
    contact_.start(all_casters_, s.up, 96, 0.12f * s.reach);
    picture.contact = contact_.view();
  }

  // Keeps the triangle in all samples where it is the nearest one so far.
  static void sample(Camera const& camera, Subject const& subject, int number, Layer& layer) {
    Triangle const& t = subject.triangles[number];
    Vec3<float> const corner[3] = {subject.view[t[0]], subject.view[t[1]], subject.view[t[2]]};
    PixelBox box;
    Facet facet;
    if (!pixel_box(camera, corner, box) || !make_facet(corner[0], corner[1], corner[2], facet))
      return;
    if (subject.closed && !facet.front) return;
    float const nearest_allowed = 1.0f / camera.near;
    float const pixel = 1.0f / camera.focal;

    // How the four linear functions change from the corner of a pixel to its samples.
    Vec3<float> const plane[4] = {facet.edge[0], facet.edge[1], facet.edge[2], facet.nearness};
    float change[4][samples];
    for (int k = 0; k < 4; ++k)
      for (int s = 0; s < samples; ++s)
        change[k][s] = pixel * (plane[k][0] * sample_column[s] - plane[k][1] * sample_row[s]);

    for (int row = box.top; row < box.bottom; ++row)
      for (int column = box.left; column < box.right; ++column) {
        Vec3<float> const d = pixel_ray(camera, float(column), float(row));
        float at[4];
        for (int k = 0; k < 4; ++k) at[k] = plane[k][0] * d[0] + (plane[k][1] * d[1] + plane[k][2]);
        float within[samples];  // negative outside of the triangle
        for (int s = 0; s < samples; ++s)
          within[s] = min(at[0] + change[0][s], min(at[1] + change[1][s], at[2] + change[2][s]));
        if (max(max(within[0], within[1]), max(within[2], within[3])) < 0.0f) continue;
        std::size_t const first =
            samples * (std::size_t(row) * std::size_t(camera.width) + std::size_t(column));
        for (int s = 0; s < samples; ++s) {
          float const n = at[3] + change[3][s];
          if (!(within[s] >= 0.0f) || n <= layer.nearness[first + s] || n > nearest_allowed)
            continue;
          layer.nearness[first + s] = n;
          layer.triangle[first + s] = subject.first + number;
        }
      }
  }

  // The colour of a pixel: the mean of its samples, where samples of the same smooth surface share one
  // ray through their middle.
  void resolve(Picture const& picture, int column, int row, Image& image) const {
    std::size_t const pixel = image.pixel(column, row);
    int const* const opaque = opaque_.triangle.data() + samples * pixel;
    float const* const near_opaque = opaque_.nearness.data() + samples * pixel;
    float const* const near_veil = veil_.nearness.data() + samples * pixel;
    int veil[samples];
    float nearest = 0.0f;
    for (int s = 0; s < samples; ++s) {
      veil[s] = near_veil[s] > near_opaque[s] ? veil_.triangle[samples * pixel + s] : none;
      nearest = max(nearest, max(near_opaque[s], near_veil[s]));
    }
    Vec3<float> light{};
    bool done[samples] = {};
    for (int s = 0; s < samples; ++s) {
      if (done[s]) continue;  // shared the ray of an earlier one
      float c = 0.0f;
      float r = 0.0f;
      float count = 0.0f;
      for (int other = s; other < samples; ++other) {
        if (done[other] || opaque[other] != opaque[s] ||
            !smooth_across(picture, veil[other], veil[s]))
          continue;
        done[other] = true;
        c += sample_column[other];
        r += sample_row[other];
        count += 1.0f;
      }
      Ray const ray = eye_ray(picture.camera, float(column) + c / count, float(row) + r / count);
      light += (count / float(samples)) * light_along(picture, opaque[s], veil[s], ray);
    }
    for (int k = 0; k < 3; ++k) image.rgb[3 * pixel + k] = code(expose(light[k]));
    image.depth[pixel] = nearest > 0.0f ? 1.0f / nearest : std::numeric_limits<float>::infinity();
  }

  // sRGB code value of a linear value, from a table: the power would cost as much as the shading.
  static std::uint8_t code(float linear) {
    static std::vector<std::uint8_t> const table = [] {
      std::vector<std::uint8_t> t(table_size);
      for (std::size_t i = 0; i < table_size; ++i)
        t[i] = std::uint8_t(std::lround(255.0f * srgb((float(i) + 0.5f) / float(table_size))));
      return t;
    }();
    // max first: it turns a NaN into black instead of an index.
    return table[std::size_t(min(max(0.0f, linear), 1.0f) * float(table_size - 1))];
  }
  static constexpr std::size_t table_size = 4096;

  std::vector<Vec3<float>> view_{};
  std::vector<Subject> subjects_{};
  Layer opaque_{};
  Layer veil_{};
  std::vector<Mesh const*> all_casters_{}, opaque_casters_{};
  ShadowMap on_tissue_{};
  ShadowMap on_ground_{};
  ShadowMap contact_{};
};

}  // namespace mpmpbd::render
