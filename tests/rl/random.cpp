// Random numbers of episodes: a function of seed, environment and episode.
#include "catch.hpp"

#include <set>

#include <mpmpbd/rl/random.hpp>

using mpmpbd::rl::Random;

TEST_CASE("the generator is Philox 4x32-10", "[rl][random]") {
  // Known answer of Random123: counter 0, key 0.
  r123::Philox4x32 const generate{};
  auto const block = generate({{}}, {{}});
  CHECK(block.v[0] == 0x6627e8d5u);
  CHECK(block.v[1] == 0xe169c58du);
  CHECK(block.v[2] == 0xbc57ac4cu);
  CHECK(block.v[3] == 0x9b00dbd8u);
  CHECK(Random(0, 0, 0).uniform() == (0x6627e8d5u >> 8) * 0x1p-24);
}

TEST_CASE("an episode has its own numbers, and always the same", "[rl][random]") {
  auto first = [](std::int64_t seed, std::int64_t env, std::int64_t episode) {
    return Random(seed, env, episode).uniform();
  };
  std::set<double> all;
  std::int64_t const far = std::int64_t{1} << 40;
  for (std::int64_t seed : {std::int64_t{1}, std::int64_t{2}, far})
    for (std::int64_t env : {0, 1, 1000})
      for (std::int64_t episode : {std::int64_t{1}, std::int64_t{2}, far}) {
        all.insert(first(seed, env, episode));
        CHECK(first(seed, env, episode) == first(seed, env, episode));
      }
  CHECK(all.size() == 27);
}

TEST_CASE("numbers are even", "[rl][random]") {
  Random random(7, 3, 1);
  int const n = 200000;
  int tenth[10] = {};
  double sum = 0, square = 0;
  for (int i = 0; i < n; ++i) {
    double const u = random.uniform();
    REQUIRE(u >= 0.0);
    REQUIRE(u < 1.0);
    ++tenth[int(10 * u)];
    sum += u;
    square += u * u;
  }
  // Within four standard deviations of a fair generator.
  CHECK(std::abs(sum / n - 0.5) < 4 * std::sqrt(1.0 / 12 / n));
  CHECK(std::abs(square / n - 1.0 / 3) < 4 * std::sqrt(4.0 / 45 / n));
  for (int count : tenth) CHECK(std::abs(count - 0.1 * n) < 4 * std::sqrt(0.09 * n));
}

TEST_CASE("a factor is as often twice as half", "[rl][random]") {
  Random random(11, 0, 1);
  int above = 0;
  double lowest = 1, highest = 1;
  for (int i = 0; i < 10000; ++i) {
    double const f = random.factor(0.5, 2.0);
    above += f > 1;
    lowest = std::min(lowest, f);
    highest = std::max(highest, f);
  }
  CHECK(lowest >= 0.5);
  CHECK(highest < 2.0);
  CHECK(std::abs(above - 5000) < 200);
  CHECK(random.factor(1.0, 1.0) == 1.0);
}
