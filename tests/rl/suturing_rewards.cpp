// Rewards of an episode, computed again from recorded positions by other means.
// seconds: 15
#include "catch.hpp"

#include "rl/suturing.hpp"

using namespace mpmpbd;
using Envs = rl::VectorEnv<rl::SuturingTask, Threads, double>;

namespace {

struct Moment {
  Vec3<double> centre, tip, entry, exit;
  int phase;
};

// A point of the sheet from the corners of its triangle.
Vec3<double> marker(Envs& envs, std::int64_t m) {
  auto const& state = envs.simulation().state();
  auto const t = state.get<marker::Triangle>(0, m);
  auto const w = state.get<marker::Weights>(0, m);
  auto const corners = state.get<sheet::Corners>(0, t);
  Vec3<double> x{};
  double const weight[] = {1 - w[0] - w[1], w[0], w[1]};
  for (int c = 0; c < 3; ++c) x += weight[c] * state.get<sheet::Position>(0, corners[c]);
  return x;
}
Moment moment(Envs& envs) {
  auto const& state = envs.simulation().state();
  auto const q = state.get<needle::Orientation>(0, 0);
  auto const k = state.parameters<ArcNeedle>(0);
  auto const centre = state.get<needle::Position>(0, 0);
  // The body's x axis, by the matrix of a quaternion (w, x, y, z).
  Vec3<double> const axis = vec(1 - 2 * (q[2] * q[2] + q[3] * q[3]),
                                2 * (q[1] * q[2] + q[0] * q[3]), 2 * (q[1] * q[3] - q[0] * q[2]));
  return {centre, centre + k.radius * axis, marker(envs, 0), marker(envs, 1),
          int(state.get<rl::stitch::Phase>(0))};
}
// Counted as the needle turns on its way: down, to the right and up again.
double angle(Vec3<double> const& from, Vec3<double> const& to) {
  double const a = std::atan2(from[2], from[0]), b = std::atan2(to[2], to[0]);
  return std::remainder(b - a, 2 * pi<double>);
}

}  // namespace

TEST_CASE("rewards follow from positions", "[rl][suturing][reward]") {
  auto c = test::suturing_config("coarse.toml");
  Envs envs(c, {.num_envs = 1, .seed = 9, .autoreset = rl::Autoreset::disabled});
  rl::SuturingExperts experts(envs);
  Moment before = moment(envs);
  double theta = angle(before.entry - before.centre, before.tip - before.centre);
  int phases[5] = {};
  double worst = 0, bonus = 0;
  for (int i = 0; i < c.episode.limit; ++i) {
    auto const& out = envs.step(experts.act(envs));
    Moment const now = moment(envs);
    double const at = angle(now.entry - now.centre, now.tip - now.centre);
    double const turned = std::remainder(at - theta, 2 * pi<double>);
    theta += turned;
    bool const inserting = before.phase == 0, driving = before.phase == 1;
    auto const& w = c.reward;
    double const expected[] = {
        inserting ? -w.entry_distance * norm(now.tip - now.entry) : 0.0,
        inserting && now.phase == 1 ? w.entry_reached : 0.0,
        driving ? w.turn_towards_exit * turned : 0.0,
        driving ? w.exit_closeness / std::max(norm(now.tip - now.exit), w.exit_closeness_least)
                : 0.0,
        driving && now.phase == 2 ? w.exit_reached : 0.0,
        driving ? -w.centre_motion * norm(now.centre - before.centre) : 0.0,
        before.phase == 2 && now.phase == 3 ? w.finished : 0.0};
    double sum = 0;
    for (int k = 0; k < 7; ++k) {
      worst = std::max(worst, std::abs(expected[k] - double(out.terms[std::size_t(k)])));
      sum += expected[k];
    }
    // The reward is a float: its rounding grows with it.
    worst = std::max(worst, std::abs(sum - double(out.reward[0])) / std::max(1.0, std::abs(sum)));
    bonus += expected[1] + expected[4] + expected[6];
    ++phases[now.phase];
    before = now;
    if (out.done(0)) break;
  }
  CAPTURE(worst);
  CHECK(worst < 1e-6);
  CHECK(phases[1] > 10);
  CHECK(phases[2] > 1);
  CHECK(phases[3] == 1);
  CHECK(bonus == c.reward.entry_reached + c.reward.exit_reached + c.reward.finished);
}
