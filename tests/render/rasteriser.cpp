#include <mpmpbd/render/rasteriser.hpp>

#include <cmath>
#include <limits>

#include "../catch.hpp"
#include "stitch_scene.hpp"

using namespace mpmpbd;
using namespace mpmpbd::render;

namespace {

// Without ground and highlights, the camera 0.5 m away in front of the plane y = 0.
Studio plain() {
  Studio s = studio(vec(-0.1f, -0.1f, -0.1f), vec(0.1f, 0.1f, 0.1f), vec(0.0f, -1.0f, 0.0f),
                    vec(0.0f, 0.0f, 1.0f));
  s.ground = false;
  return s;
}
Camera front(int width = 200, int height = 160) {
  return look_at(vec(0.0f, -0.5f, 0.0f), Vec3<float>{}, vec(0.0f, 0.0f, 1.0f), 0.5f, width, height);
}

Finish paint(Vec3<float> const& colour) {
  Finish finish = suture();
  finish.colour = colour;
  return finish;
}
Vec3<float> const red = vec(0.7f, 0.02f, 0.02f);
Vec3<float> const green = vec(0.02f, 0.6f, 0.02f);

// An open sheet of one rectangle, corners in counter-clockwise order.
Mesh rectangle(Vec3<float> const& a, Vec3<float> const& b, Vec3<float> const& c,
               Vec3<float> const& d) {
  Mesh mesh;
  mesh.positions = {a, b, c, d};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  compute_normals(mesh);
  return mesh;
}
// A square of half side h [m] in the plane at y, facing the camera.
Mesh square_at(float y, float h) {
  return rectangle(vec(-h, y, -h), vec(h, y, -h), vec(h, y, h), vec(-h, y, h));
}

bool reddish(Image const& image, int column, int row) {
  std::uint8_t const* c = &image.rgb[3 * image.pixel(column, row)];
  return c[0] > 2 * c[1] && c[0] > 2 * c[2];
}
bool greenish(Image const& image, int column, int row) {
  std::uint8_t const* c = &image.rgb[3 * image.pixel(column, row)];
  return c[1] > 2 * c[0] && c[1] > 2 * c[2];
}
bool empty(Image const& image, int column, int row) {
  return std::isinf(image.depth[image.pixel(column, row)]);
}

Image drawn(Camera const& camera, Studio const& s, std::vector<Object> const& objects) {
  Rasteriser rasteriser;
  Image image;
  rasteriser.draw(camera, s, objects, image);
  return image;
}

}  // namespace

TEST_CASE("a nearer triangle hides a farther one, whichever is drawn first",
          "[render][rasteriser]") {
  Mesh const near = square_at(-0.03f, 0.02f);
  Mesh const far = square_at(0.04f, 0.05f);
  Object const a{&near, paint(red)};
  Object const b{&far, paint(green)};
  Image const one = drawn(front(), plain(), {a, b});
  Image const other = drawn(front(), plain(), {b, a});
  CHECK(one.rgb == other.rgb);
  CHECK(reddish(one, 100, 80));
  CHECK(greenish(one, 100, 80 - 20));
  CHECK(empty(one, 5, 5));
}

TEST_CASE("two triangles that pass through each other are cut along their common line",
          "[render][rasteriser]") {
  // Tilted about the vertical: red is in front on the left, green on the right.
  Mesh const a = rectangle(vec(-0.06f, -0.05f, -0.06f), vec(0.06f, 0.05f, -0.06f),
                           vec(0.06f, 0.05f, 0.06f), vec(-0.06f, -0.05f, 0.06f));
  Mesh const b = rectangle(vec(-0.06f, 0.05f, -0.06f), vec(0.06f, -0.05f, -0.06f),
                           vec(0.06f, -0.05f, 0.06f), vec(-0.06f, 0.05f, 0.06f));
  Image const image = drawn(front(), plain(), {{&a, paint(red)}, {&b, paint(green)}});
  for (int row = 60; row < 100; row += 7) {
    CHECK(reddish(image, 98, row));
    CHECK(greenish(image, 101, row));
  }
}

TEST_CASE("the depth of a tilted plane is right in every pixel", "[render][rasteriser]") {
  // The plane y = 0.1 + 2 z, seen under perspective.
  float const h = 0.4f;
  Mesh const plane = rectangle(vec(-h, 0.1f - 2.0f * h, -h), vec(h, 0.1f - 2.0f * h, -h),
                               vec(h, 0.1f + 2.0f * h, h), vec(-h, 0.1f + 2.0f * h, h));
  Camera const camera = front();
  Image const image = drawn(camera, plain(), {{&plane, paint(red)}});
  for (int row = 3; row < 160; row += 9)
    for (int column = 5; column < 200; column += 13) {
      float const slope = pixel_ray(camera, float(column) + 0.5f, float(row) + 0.5f)[2 - 1];
      // y = -0.5 + t, z = slope t: t = 0.6 / (1 - 2 slope); the nearest sample is within half a pixel.
      float const expected = 0.6f / (1.0f - 2.0f * slope);
      float const step = expected * 2.0f / camera.focal / (1.0f - 2.0f * slope);
      CHECK_THAT(image.depth[image.pixel(column, row)], WithinAbs(double(expected), double(step)));
    }
}

TEST_CASE("perspective keeps a straight edge straight", "[render][rasteriser]") {
  // A strip from close by to far away; its right edge is a line in space and must be one in the picture.
  Mesh const strip = rectangle(vec(-0.04f, -0.3f, -0.05f), vec(0.03f, -0.3f, -0.05f),
                               vec(0.05f, 3.0f, 0.3f), vec(-0.04f, 3.0f, 0.3f));
  Camera const camera = front(400, 320);
  Image const image = drawn(camera, plain(), {{&strip, paint(red)}});
  Vec<float, 2> const a = to_pixel(camera, to_view(camera, strip.positions[1]));
  Vec<float, 2> const b = to_pixel(camera, to_view(camera, strip.positions[2]));
  int rows = 0;
  for (int row = int(b[1]) + 3; row < min(int(a[1]) - 3, 319); ++row, ++rows) {
    float const edge = a[0] + (b[0] - a[0]) * (float(row) + 0.5f - a[1]) / (b[1] - a[1]);
    CHECK_FALSE(empty(image, int(edge) - 2, row));
    CHECK(empty(image, int(edge) + 2, row));
  }
  CHECK(rows > 100);
}

TEST_CASE("a square covers as many pixels as its projection", "[render][rasteriser]") {
  float const h = 0.043f;
  Mesh const mesh = square_at(0.02f, h);
  Camera const camera = front();
  Studio s = plain();
  s.horizon = s.zenith = Vec3<float>{};
  Finish finish = paint(red);
  Image const image = drawn(camera, s, {{&mesh, finish}});
  int covered = 0;
  for (float depth : image.depth) covered += std::isinf(depth) ? 0 : 1;
  double const side = 2.0 * double(h * camera.focal) / 0.52;
  CHECK_THAT(covered, WithinAbs(side * side, 2.5 * side));  // the rim counts when it is touched
}

TEST_CASE("an edge that cuts a pixel gives it a colour in between", "[render][rasteriser]") {
  Camera const camera = front();
  // The left edge of the rectangle runs through the middle of column 100.
  float const x = pixel_ray(camera, 100.5f, 80.0f)[0] * 0.5f;
  Mesh const mesh = rectangle(vec(x, 0.0f, -0.03f), vec(0.04f, 0.0f, -0.03f),
                              vec(0.04f, 0.0f, 0.03f), vec(x, 0.0f, 0.03f));
  Image const image = drawn(camera, plain(), {{&mesh, paint(green)}});
  int const outside = image.rgb[3 * image.pixel(98, 80)];
  int const rim = image.rgb[3 * image.pixel(100, 80)];
  int const inside = image.rgb[3 * image.pixel(103, 80)];
  CHECK(outside > rim + 20);
  CHECK(rim > inside + 20);
}

TEST_CASE("a triangle that reaches behind the eye is drawn as far as it is in front",
          "[render][rasteriser]") {
  // A floor under the camera, once to far behind it, once cut off close in front of it.
  Mesh const long_floor = rectangle(vec(-9.0f, -8.0f, -0.1f), vec(9.0f, -8.0f, -0.1f),
                                    vec(9.0f, 6.0f, -0.1f), vec(-9.0f, 6.0f, -0.1f));
  Mesh const short_floor = rectangle(vec(-9.0f, -0.4f, -0.1f), vec(9.0f, -0.4f, -0.1f),
                                     vec(9.0f, 6.0f, -0.1f), vec(-9.0f, 6.0f, -0.1f));
  Image const a = drawn(front(), plain(), {{&long_floor, paint(red)}});
  Image const b = drawn(front(), plain(), {{&short_floor, paint(red)}});
  int seen = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    CHECK(std::isinf(a.depth[i]) == std::isinf(b.depth[i]));
    if (std::isinf(a.depth[i])) continue;
    CHECK_THAT(a.depth[i], WithinRel(b.depth[i], 2e-3f));
    ++seen;
  }
  CHECK(seen > 5000);
}

TEST_CASE("what is behind the eye or nearer than the near plane is not drawn",
          "[render][rasteriser]") {
  Camera camera = front();
  camera.near = 0.05f;
  Mesh const behind = square_at(-0.9f, 0.2f);
  Mesh const close = square_at(-0.46f, 0.2f);
  Image const image = drawn(camera, plain(), {{&behind, paint(red)}, {&close, paint(red)}});
  for (float depth : image.depth) REQUIRE(std::isinf(depth));
}

TEST_CASE("no ray passes between neighbouring triangles", "[render][rasteriser]") {
  // A sheet of many triangles at a shallow angle that fills the picture, with vertices in general position.
  int const n = 61;
  Mesh sheet;
  std::vector<int> grid;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      float const u = float(i) / float(n - 1) - 0.5f;
      float const v = float(j) / float(n - 1) - 0.5f;
      grid.push_back(int(sheet.positions.size()));
      sheet.positions.push_back(vec(1.7f * u + 0.006f * sin(91.0f * v), 0.3f + 1.4f * v,
                                    1.3f * v + 0.004f * sin(77.0f * u)));
    }
  append_grid(sheet, grid, n);
  compute_normals(sheet);
  Image const image = drawn(front(333, 277), plain(), {{&sheet, paint(red)}});
  for (float depth : image.depth) REQUIRE_FALSE(std::isinf(depth));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) REQUIRE(reddish(image, column, row));
}

TEST_CASE("a translucent sheet of many small triangles is as bright as one of two large ones",
          "[render][rasteriser]") {
  // Several triangles in a pixel: neighbours in a row share vertices, the first and the last of it do not.
  int const n = 211;
  Mesh fine;
  std::vector<int> grid;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      grid.push_back(int(fine.positions.size()));
      fine.positions.push_back(vec(0.4f * (float(i) / float(n - 1) - 0.5f), 0.0f,
                                   0.4f * (float(j) / float(n - 1) - 0.5f)));
    }
  append_grid(fine, grid, n);
  compute_normals(fine);
  Mesh const coarse = square_at(0.0f, 0.2f);
  Finish skin = tissue(0.1f);
  skin.mottle = skin.bump = 0.0f;
  Camera const camera = front(80, 64);
  Image const small = drawn(camera, plain(), {{&fine, skin}});
  Image const large = drawn(camera, plain(), {{&coarse, skin}});
  for (int row = 8; row < 56; ++row)
    for (int column = 8; column < 72; ++column)
      for (std::size_t k = 0; k < 3; ++k) {
        std::size_t const at = 3 * small.pixel(column, row) + k;
        REQUIRE(std::abs(int(small.rgb[at]) - int(large.rgb[at])) <= 2);
      }
}

TEST_CASE("a closed body looks the same with and without its inner side", "[render][rasteriser]") {
  stitch_scene::Scene scene = stitch_scene::make();
  Camera const camera = stitch_scene::camera(160, 120);
  Image const closed = drawn(camera, stitch_scene::studio(scene), scene.objects());
  scene.tissue.closed = scene.needle.closed = scene.thread.closed = false;
  Image const open = drawn(camera, stitch_scene::studio(scene), scene.objects());
  int different = 0;
  for (std::size_t i = 0; i < closed.rgb.size(); ++i)
    different += closed.rgb[i] != open.rgb[i] ? 1 : 0;
  CHECK(different <
        int(closed.rgb.size()) / 500);  // silhouettes, where a sample sees the far side's rim
}

TEST_CASE("two renderings of the same scene are the same bytes", "[render][rasteriser]") {
  stitch_scene::Scene const scene = stitch_scene::make();
  stitch_scene::Scene const earlier = stitch_scene::make(350.0f);
  Camera const camera = stitch_scene::camera(250, 250);
  Rasteriser rasteriser;
  Image first;
  Image second;
  rasteriser.draw(camera, stitch_scene::studio(scene), scene.objects(), first);
  rasteriser.draw(camera, stitch_scene::studio(scene), earlier.objects(), second);
  CHECK(first.rgb != second.rgb);
  rasteriser.draw(camera, stitch_scene::studio(scene), scene.objects(), second);
  CHECK(first.rgb == second.rgb);
  CHECK(first.depth == second.depth);
}

TEST_CASE("a picture does not depend on the unit of length", "[render][rasteriser]") {
  // The same scene 64 times smaller: a power of two, so that only what has a hidden length differs.
  stitch_scene::Scene scene = stitch_scene::make();
  float const s = 1.0f / 64.0f;
  Camera camera = stitch_scene::camera(200, 150);
  Image const large = drawn(camera, stitch_scene::studio(scene), scene.objects());
  for (Mesh* mesh : {&scene.tissue, &scene.needle, &scene.thread})
    for (auto* points : {&mesh->positions, &mesh->material})
      for (Vec3<float>& x : *points) x *= s;
  scene.low *= s;
  scene.high *= s;
  for (Marker& m : scene.markers) m = {s * m.centre, s * m.radius, m.colour};
  camera.eye *= s;
  camera.near *= s;
  std::vector<Object> objects = scene.objects();
  objects[0].finish = tissue(s);
  Image const small = drawn(camera, stitch_scene::studio(scene), objects);
  int different = 0;
  for (std::size_t i = 0; i < large.rgb.size(); ++i)
    different += abs(float(large.rgb[i]) - float(small.rgb[i])) > 2.0f;
  CHECK(different < int(large.rgb.size()) / 1000);
}

TEST_CASE("a marker is painted where its material point is, and moves with it",
          "[render][rasteriser]") {
  Mesh sheet = square_at(0.0f, 0.06f);
  sheet.material = sheet.positions;
  Marker const marker{vec(0.02f, 0.0f, 0.01f), 0.008f, green};
  Camera const camera = front(400, 320);
  Vec3<float> const shift = vec(-0.03f, 0.05f, 0.015f);
  for (bool moved : {false, true}) {
    if (moved)
      for (Vec3<float>& x : sheet.positions) x += shift;
    Image const image = drawn(camera, plain(), {{&sheet, paint(red), std::span(&marker, 1)}});
    Vec3<float> const centre = marker.centre + (moved ? shift : Vec3<float>{});
    for (float angle = 0.0f; angle < 6.2f; angle += 0.7f) {
      auto const at = [&](float r) {
        Vec3<float> const p =
            centre + vec(r * marker.radius * cos(angle), 0.0f, r * marker.radius * sin(angle));
        return to_pixel(camera, to_view(camera, p));
      };
      CHECK(greenish(image, int(at(0.8f)[0]), int(at(0.8f)[1])));
      CHECK(reddish(image, int(at(1.25f)[0]), int(at(1.25f)[1])));
    }
  }
}

TEST_CASE(
    "an inner object shows through a thin layer of tissue, fades with depth, and is gone deep inside",
    "[render][rasteriser]") {
  float const size = 0.02f;  // the block of the preset `phantom`
  Mesh const block = box_surface(vec(-0.04f, 0.0f, -0.04f), vec(0.04f, 0.02f, 0.04f), {{8, 4, 8}});
  Finish skin = tissue(size);
  skin.mottle = 0.0f;
  Image const alone = drawn(front(), plain(), {{&block, skin}});
  float last = 1e9f;
  for (float const depth : {0.0005f, 0.002f, 0.006f, 0.015f}) {
    Mesh const inner = square_at(depth, 0.01f);
    Image const image =
        drawn(front(), plain(), {{&block, skin}, {&inner, paint(vec(0.02f, 0.02f, 0.6f))}});
    float difference = 0.0f;
    for (std::size_t k = 0; k < 3; ++k)
      difference += abs(float(image.rgb[3 * image.pixel(100, 80) + k]) -
                        float(alone.rgb[3 * image.pixel(100, 80) + k]));
    CHECK(difference < last);
    if (depth == 0.0005f) CHECK(difference > 60.0f);
    if (depth == 0.015f) CHECK(difference < 12.0f);
    last = difference;
    // Beside the inner object nothing changes but its absence.
    CHECK(image.rgb[3 * image.pixel(30, 80)] == alone.rgb[3 * image.pixel(30, 80)]);
  }
}

TEST_CASE("a rod over the tissue throws a shadow away from the light, a rod inside throws none",
          "[render][rasteriser]") {
  Mesh const block = box_surface(vec(-0.5f, -0.5f, 0.0f), vec(0.5f, 0.5f, 0.2f), {{20, 20, 4}});
  Studio const s = studio(vec(-0.5f, -0.5f, 0.0f), vec(0.5f, 0.5f, 0.2f), vec(0.0f, -1.0f, 1.0f),
                          vec(0.0f, 0.0f, 1.0f));
  Camera const camera =
      look_at(vec(0.0f, 0.0f, 3.0f), vec(0.0f, 0.0f, 0.2f), vec(0.0f, 1.0f, 0.0f), 0.3f, 200, 200);
  Finish skin = tissue(0.2f);
  skin.mottle = 0.0f;
  auto const rod = [](float z) {
    return TubeMaker{}.thread(std::vector{vec(0.1f, -0.3f, z), vec(0.1f, 0.3f, z)}, 0.02f);
  };
  auto const brightness = [&](float z, Vec3<float> const& point) {
    Mesh const mesh = rod(z);
    Image const image = drawn(camera, s, {{&block, skin}, {&mesh, suture()}});
    Vec<float, 2> const pixel = to_pixel(camera, to_view(camera, point));
    return int(image.rgb[3 * image.pixel(int(pixel[0]), int(pixel[1])) + 1]);
  };
  // Where the line from the rod along the light meets the surface, and as far on the other side.
  float const height = 0.15f;
  float const throw_x = -height * s.key[0] / s.key[2];
  Vec3<float> const shaded = vec(0.1f + throw_x, 0.0f, 0.2f);
  Vec3<float> const lit = vec(0.1f - throw_x, 0.0f, 0.2f);
  CHECK(brightness(0.2f + height, shaded) < brightness(0.2f + height, lit) - 30);
  CHECK(abs(float(brightness(0.12f, shaded) - brightness(0.12f, lit))) < 6.0f);
}

TEST_CASE("vertices that are not finite take their triangles with them and nothing else",
          "[render][rasteriser]") {
  Mesh sheet = square_at(0.0f, 0.03f);
  Mesh broken = square_at(-0.1f, 0.04f);
  broken.positions[1] = vec(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
  broken.positions[3] = vec(std::numeric_limits<float>::infinity(), 0.0f, 0.0f);
  compute_normals(broken);
  Image const image = drawn(front(), plain(), {{&sheet, paint(red)}, {&broken, paint(green)}});
  CHECK(reddish(image, 100, 80));
}

TEST_CASE("nothing to draw leaves ground and background", "[render][rasteriser]") {
  Studio s = plain();
  s.ground = true;
  s.ground_height = -0.1f;
  Image const image = drawn(front(), s, {});
  for (float depth : image.depth) REQUIRE(std::isinf(depth));
  CHECK(image.rgb[3 * image.pixel(100, 5)] != image.rgb[3 * image.pixel(100, 155)]);
}
