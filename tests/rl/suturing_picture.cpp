// The camera of the suturing task.
// seconds: 20
#include "catch.hpp"

#include <algorithm>

#include <mpmpbd/catalog/suturing_task.hpp>

#include "rl/suturing.hpp"
#include "support/counted_allocations.hpp"

using namespace mpmpbd;
using rl::CameraPicture;

namespace {

template <class Backend> using Envs = rl::VectorEnv<rl::SuturingFromPictures, Backend>;
constexpr int width = 80, height = 60;

rl::SuturingTaskConfig config() {
  return test::suturing_config("coarse.toml", {"picture.width=80", "picture.height=60"});
}
// What one environment shows: frames, one after another.
template <class V> std::vector<std::uint8_t> picture(V const& envs, std::int64_t env) {
  auto const all = envs.template observation<CameraPicture>();
  auto const n = std::int64_t(all.size()) / envs.num_envs();
  return {all.begin() + env * n, all.begin() + (env + 1) * n};
}
std::vector<float> actions(std::int64_t num_envs) {
  std::vector<float> a;
  for (std::int64_t e = 0; e < num_envs; ++e)
    for (float x : {0.3f, -0.8f, 0.2f}) a.push_back(x);
  return a;
}

}  // namespace

TEST_CASE("an agent sees what a picture of the scene shows", "[rl][suturing][picture]") {
  auto const c = test::without_differences(config());
  Envs<Serial> envs(c, {.num_envs = 1});
  envs.step(actions(1));
  suturing::StitchPicture const by_hand(c.scene);
  suturing::Canvas canvas;
  render::Image image;
  by_hand.draw(canvas, suturing::Moment::of(envs.simulation(), 0, 0.0), width, height, image);
  CHECK(envs.shape<CameraPicture>() == std::vector<std::int64_t>{height, width, 3});
  CHECK(picture(envs, 0) == image.rgb);
  CHECK(image.rgb.size() == std::size_t(3 * width * height));
}

TEST_CASE("a picture depends on its own episode only", "[rl][suturing][picture]") {
  auto c = config();
  c.episode.frames = 3;
  Envs<Threads> together(c, {.num_envs = 3, .seed = 4}, Threads{2});
  Envs<Serial> alone(c, {.num_envs = 1, .seed = 4, .first_environment = 2});
  CHECK(picture(together, 2) == picture(alone, 0));
  for (int i = 0; i < 4; ++i) {
    together.step(actions(3));
    alone.step(actions(1));
    CHECK(picture(together, 2) == picture(alone, 0));
  }
  CHECK(picture(together, 1) != picture(together, 2));
  // Three frames, the newest last: the needle has moved between them.
  auto const frames = picture(together, 2);
  std::size_t const n = 3 * width * height;
  REQUIRE(frames.size() == 3 * n);
  CHECK_FALSE(std::equal(frames.begin(), frames.begin() + n, frames.begin() + n));
  CHECK_FALSE(std::equal(frames.begin() + n, frames.begin() + 2 * n, frames.begin() + 2 * n));
}

TEST_CASE("camera and colours differ between episodes", "[rl][suturing][picture]") {
  auto mean = [](std::vector<std::uint8_t> const& rgb, int channel) {
    double sum = 0;
    for (std::size_t i = std::size_t(channel); i < rgb.size(); i += 3) sum += rgb[i];
    return sum / double(rgb.size() / 3);
  };
  auto c = test::without_differences(config());
  c.random.colour = 1.3;
  Envs<Serial> coloured(c, {.num_envs = 1});
  double least = 255, most = 0;
  for (int k = 1; k <= 12; ++k) {
    coloured.start(0, k);
    double const redness = mean(picture(coloured, 0), 0) / mean(picture(coloured, 0), 1);
    least = std::min(least, redness);
    most = std::max(most, redness);
  }
  CHECK(most > 1.05 * least);

  c.random.colour = 1.0;
  c.random.camera_shift = 0.1;
  Envs<Serial> moved(c, {.num_envs = 1});
  moved.start(0, 1);
  auto const first = picture(moved, 0);
  moved.start(0, 2);
  CHECK(picture(moved, 0) != first);
  moved.start(0, 1);
  CHECK(picture(moved, 0) == first);
}

TEST_CASE("drawing allocates nothing", "[rl][suturing][picture][memory]") {
  auto c = config();
  c.episode.limit = 3;
  c.episode.frames = 3;
  Envs<Serial> envs(c, {.num_envs = 2});
  auto const a = actions(2);
  envs.step(a);
  std::int64_t const before = test::allocations;
  REQUIRE((before > 0) == test::counts_allocations);
  for (int i = 0; i < 8; ++i) envs.step(a);  // new episodes are part of it
  CHECK(test::allocations == before);
}
