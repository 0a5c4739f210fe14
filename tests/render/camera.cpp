#include <mpmpbd/render/camera.hpp>
#include <mpmpbd/render/studio.hpp>

#include "../catch.hpp"

using namespace mpmpbd;
using namespace mpmpbd::render;

namespace {

Vec3<float> const eye = vec(2.3f, -4.1f, 1.9f);
Vec3<float> const target = vec(0.4f, 0.3f, 0.7f);
Vec3<float> const up = vec(0.0f, 0.0f, 1.0f);

Vec<float, 2> pixel_of(Camera const& camera, Vec3<float> const& point) {
  return to_pixel(camera, to_view(camera, point));
}

}  // namespace

TEST_CASE("the target is in the middle, what is higher is above, what is right is right",
          "[render][camera]") {
  Camera const camera = look_at(eye, target, up, 0.6f, 640, 360);
  Vec<float, 2> const middle = pixel_of(camera, target);
  CHECK_THAT(middle[0], WithinAbs(320.0, 1e-3));
  CHECK_THAT(middle[1], WithinAbs(180.0, 1e-3));
  CHECK(pixel_of(camera, target + vec(0.0f, 0.0f, 0.2f))[1] < 179.0f);
  // Looking along +y from x > 0 tilts little: +x stays on the right.
  CHECK(pixel_of(camera, target + vec(0.2f, 0.0f, 0.0f))[0] > 321.0f);
}

TEST_CASE("a camera that looks straight down has y at the top and x on the right",
          "[render][camera]") {
  for (Vec3<float> const& above : {target + 2.5f * up, target - 2.5f * up}) {
    Camera const camera = look_at(above, target, up, 0.6f, 640, 360);
    CHECK_THAT(norm(camera.right), WithinAbs(1.0, 1e-6));
    CHECK_THAT(norm(camera.up), WithinAbs(1.0, 1e-6));
    CHECK(dot(camera.right, camera.up) == 0.0f);
    CHECK(pixel_of(camera, target + vec(0.2f, 0.0f, 0.0f))[0] > 321.0f);
  }
  Camera const down = look_at(target + 2.5f * up, target, up, 0.6f, 640, 360);
  CHECK(pixel_of(down, target + vec(0.0f, 0.2f, 0.0f))[1] < 179.0f);
}

TEST_CASE("seen from straight above, a scene is lit from two sides", "[render][camera]") {
  Studio const s = studio(vec(-1.0f, -1.0f, -1.0f), vec(1.0f, 1.0f, 1.0f), up, up);
  CHECK(norm(cross(s.key, up)) > 0.5f);
  CHECK(norm(cross(s.fill, up)) > 0.5f);
  CHECK(dot(s.key, s.fill) < 0.5f);
}

TEST_CASE("the vertical field of view reaches from the first to the last row", "[render][camera]") {
  float const angle = 0.6f;
  Camera const camera = look_at(eye, target, up, angle, 640, 360);
  float const tangent = sin(0.5f * angle) / cos(0.5f * angle);
  float const distance = norm(target - eye);
  CHECK_THAT(pixel_of(camera, target + (distance * tangent) * camera.up)[1], WithinAbs(0.0, 1e-2));
  CHECK_THAT(pixel_of(camera, target - (distance * tangent) * camera.up)[1],
             WithinAbs(360.0, 1e-2));
}

TEST_CASE("the ray through the pixel of a point passes through the point", "[render][camera]") {
  Camera const camera = look_at(eye, target, up, 0.9f, 250, 250);
  for (Vec3<float> const& p :
       {vec(0.1f, 0.9f, 0.2f), vec(-1.4f, 0.5f, 1.3f), vec(1.0f, -0.7f, 0.05f)}) {
    Vec3<float> const view = to_view(camera, p);
    Vec<float, 2> const pixel = to_pixel(camera, view);
    Vec3<float> const hit = to_world(camera, view[2] * pixel_ray(camera, pixel[0], pixel[1]));
    CHECK(norm(hit - p) < 2e-6f * norm(p - eye));
  }
}

TEST_CASE("a framed box is in the picture whole, and as large as the margin allows",
          "[render][camera]") {
  // Metres and millimetres, wide, square and high pictures, from several sides.
  for (float const size : {1.0f, 0.02f})
    for (int const width : {1280, 250, 120})
      for (Vec3<float> const& side :
           {vec(0.2f, -1.0f, 0.8f), vec(-1.0f, 0.1f, 0.05f), vec(0.3f, 0.2f, 1.0f)}) {
        int const height = 250;
        Vec3<float> const low = size * vec(-1.3f, -0.4f, 0.2f);
        Vec3<float> const high = size * vec(0.9f, 0.7f, 1.1f);
        Camera const camera = frame_box(low, high, side, up, width, height, 0.5f, 0.1f);
        float least[2] = {1e9f, 1e9f};
        float most[2] = {-1e9f, -1e9f};
        for (int corner = 0; corner < 8; ++corner) {
          Vec3<float> const p = vec(corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1],
                                    corner & 4 ? high[2] : low[2]);
          Vec<float, 2> const pixel = pixel_of(camera, p);
          for (int i = 0; i < 2; ++i) {
            least[i] = min(least[i], pixel[i]);
            most[i] = max(most[i], pixel[i]);
          }
        }
        float const extent[2] = {float(width), float(height)};
        // Across or up, one of the two touches the margin on both sides.
        float fill = 0.0f;
        for (int i = 0; i < 2; ++i) {
          CHECK(least[i] > 0.0499f * extent[i]);
          CHECK(most[i] < 0.9501f * extent[i]);
          fill = max(fill, (most[i] - least[i]) / extent[i]);
        }
        CHECK_THAT(fill, WithinRel(0.9f, 1e-3f));
      }
}
