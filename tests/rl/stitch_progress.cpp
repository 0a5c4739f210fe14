// Angles, distances and phases of the suturing task, on hand-made poses and events.
#include "catch.hpp"

#include "rl/suturing.hpp"

using namespace mpmpbd;
using rl::StitchPhase;
using Envs = rl::VectorEnv<rl::SuturingTask, Serial, double>;

namespace {

// An environment into which tests write what they like.
struct Hand {
  Envs envs{test::without_differences(test::suturing_config("coarse.toml")), {.num_envs = 1}};
  SuturingConfig const& scene = envs.config().scene;

  auto env() {
    return access_environment(envs.simulation().state(), 0, typename Envs::Sim::Store::Domains{});
  }
  auto context() { return envs.simulation().context(0); }
  // The needle's centre at x, its tip seen from there at an angle from the x axis.
  void place(Vec3<double> const& centre, double turn) {
    auto const needles = env().domain<Needles>();
    needle::set_pose(needles.view, needles.first,
                     Pose<double>{centre, rl::plane::orientation(turn)});
  }
  // The needle on its path, so far past the entry marker.
  void place_on_path(double past) {
    auto const path = scene.path();
    auto const needles = env().domain<Needles>();
    needle::set_pose(needles.view, needles.first, path.pose(past));
  }
  void raise(EventKind kind, double miss) {
    auto const access = env();
    auto const events = access.domain<Events>();
    auto const environments = access.domain<Environments>();
    event_log(events.view, environments.view, environments.first)
        .append({kind, 0, {0, {}}, {}, 0, 0.0, 0.0, miss});
  }
  void decide() { rl::StitchProgress::decide(env(), context()); }
  StitchPhase advance() {
    rl::StitchProgress::advance(env(), context());
    return rl::stitch::phase(env());
  }
  template <class Term> double reward() { return Term::value(env(), context()); }
  void tip_is(TipState state) { env().set<tip::State>(0, std::int64_t(state)); }
};

}  // namespace

TEST_CASE("markers lie where the settings put them", "[rl][suturing]") {
  Hand h;
  CHECK(norm(rl::stitch::marker_position(h.env(), rl::stitch::entry) - h.scene.entry()) < 1e-12);
  CHECK(norm(rl::stitch::marker_position(h.env(), rl::stitch::exit) - h.scene.exit()) < 1e-12);
}

TEST_CASE("angles are counted from a marker to the tip, towards the exit", "[rl][suturing]") {
  Hand h;
  auto const path = h.scene.path();
  for (double past : {-0.4, 0.0, 0.7, 2.0}) {
    h.place_on_path(past);
    CHECK(rl::stitch::angle_past(h.env(), h.context(), rl::stitch::entry) ==
          Approx(past).margin(1e-12));
    CHECK(rl::stitch::angle_past(h.env(), h.context(), rl::stitch::exit) ==
          Approx(past - path.angle).margin(1e-12));
  }
  // By hand: centre 0.4 above the entry, tip to the right of it: a quarter turn from straight down.
  h.place(h.scene.entry() + vec(0.0, 0.0, 0.4), 0.0);
  CHECK(rl::stitch::angle_past(h.env(), h.context(), rl::stitch::entry) ==
        Approx(pi<double> / 2).margin(1e-12));
  auto const tip = rl::stitch::tip_position(h.env(), h.context());
  CHECK(norm(tip - h.scene.entry() - vec(h.scene.needle.radius, 0.0, 0.4)) < 1e-12);
}

TEST_CASE("the angle counts on past half a turn", "[rl][suturing]") {
  Hand h;
  for (int i = 0; i <= 40; ++i) {
    h.place_on_path(0.1 * i);
    h.advance();
  }
  CHECK(h.env().get<rl::stitch::Angle>(0) == Approx(4.0).margin(1e-9));
  for (int i = 40; i >= 0; --i) {
    h.place_on_path(0.1 * i);
    h.advance();
  }
  CHECK(h.env().get<rl::stitch::Angle>(0) == Approx(0.0).margin(1e-9));
}

TEST_CASE("distance and turn are paid for in their own phase", "[rl][suturing][reward]") {
  Hand h;
  h.place(h.scene.entry() + vec(0.1, 0.0, 0.5), 0.3);
  h.decide();
  auto const weights = h.envs.config().reward;
  auto const tip = h.scene.entry() + vec(0.1, 0.0, 0.5) +
                   h.scene.needle.radius * vec(std::cos(0.3), 0.0, std::sin(0.3));
  CHECK(h.reward<rl::EntryDistance>() ==
        Approx(-weights.entry_distance * norm(tip - h.scene.entry())).epsilon(1e-12));
  CHECK(h.reward<rl::TurnTowardsExit>() == 0.0);
  CHECK(h.reward<rl::ExitCloseness>() == 0.0);
  CHECK(h.reward<rl::CentreMotion>() == 0.0);

  h.raise(EventKind::entry, 0.01);
  REQUIRE(h.advance() == StitchPhase::driving);
  h.place_on_path(0.5);
  h.advance();
  h.decide();
  h.place_on_path(0.75);
  auto const needles = h.env().domain<Needles>();
  auto pose = needle::pose(needles.view, needles.first);
  pose.position += vec(0.03, 0.0, -0.04);
  needle::set_pose(needles.view, needles.first, pose);
  double const before = h.env().get<rl::stitch::Angle>(0);
  h.advance();
  double const turned = h.env().get<rl::stitch::Angle>(0) - before;
  CHECK(h.reward<rl::EntryDistance>() == 0.0);
  CHECK(h.reward<rl::TurnTowardsExit>() == Approx(weights.turn_towards_exit * turned));
  CHECK(h.reward<rl::CentreMotion>() == Approx(-weights.centre_motion * 0.05).epsilon(1e-9));
  double const away = norm(rl::stitch::tip_position(h.env(), h.context()) - h.scene.exit());
  CHECK(h.reward<rl::ExitCloseness>() == Approx(weights.exit_closeness / away).epsilon(1e-9));
}

TEST_CASE("the closeness of the exit has a bound", "[rl][suturing][reward]") {
  Hand h;
  h.raise(EventKind::entry, 0.0);
  h.advance();
  h.decide();
  h.place_on_path(h.scene.path().angle);  // the tip on the exit marker
  auto const weights = h.envs.config().reward;
  CHECK(h.reward<rl::ExitCloseness>() ==
        Approx(weights.exit_closeness / weights.exit_closeness_least));
}

TEST_CASE("only a puncture near the entry marker opens the driving phase",
          "[rl][suturing][reward]") {
  Hand h;
  auto const weights = h.envs.config().reward;
  h.decide();
  h.place_on_path(0.2);  // the tip is in tissue beside the marker, but has not gone in
  h.tip_is(TipState::inside);
  CHECK(h.advance() == StitchPhase::insertion);
  CHECK(h.reward<rl::EntryReached>() == 0.0);
  h.raise(EventKind::exit, 0.0);  // neither does coming out
  CHECK(h.advance() == StitchPhase::insertion);
  h.raise(EventKind::entry, 0.074);
  CHECK(h.advance() == StitchPhase::driving);
  CHECK(h.reward<rl::EntryReached>() == weights.entry_reached);
  CHECK(h.env().get<rl::stitch::EntryMiss>(0) == 0.074);
  // It is paid for once.
  h.decide();
  h.raise(EventKind::entry, 0.0);
  CHECK(h.advance() == StitchPhase::driving);
  CHECK(h.reward<rl::EntryReached>() == 0.0);
  CHECK(h.env().get<rl::stitch::EntryMiss>(0) == 0.074);
}

TEST_CASE("a puncture elsewhere loses the stitch", "[rl][suturing][reward]") {
  Hand h;
  h.decide();
  h.raise(EventKind::entry, 0.076);
  CHECK(h.advance() == StitchPhase::lost);
  CHECK(h.reward<rl::EntryReached>() == 0.0);
  CHECK(h.env().get<rl::stitch::EntryMiss>(0) == 0.076);
  CHECK(rl::StitchOver::holds(h.env(), h.context()));
}

TEST_CASE("the exit is paid for when the tip comes out there, after a puncture",
          "[rl][suturing][reward]") {
  Hand h;
  auto const weights = h.envs.config().reward;
  h.raise(EventKind::entry, 0.0);
  h.advance();
  h.decide();
  h.place_on_path(h.scene.path().angle);  // at the marker, from below
  h.tip_is(TipState::inside);
  CHECK(h.advance() == StitchPhase::driving);
  CHECK(h.reward<rl::ExitReached>() == 0.0);
  h.raise(EventKind::exit, 0.05);
  h.tip_is(TipState::outside);
  CHECK(h.advance() == StitchPhase::extraction);
  CHECK(h.reward<rl::ExitReached>() == weights.exit_reached);
  CHECK(h.env().get<rl::stitch::ExitMiss>(0) == 0.05);
  CHECK_FALSE(rl::StitchOver::holds(h.env(), h.context()));

  h.decide();
  h.place_on_path(h.scene.path().angle + 0.5);  // 29 degrees
  CHECK(h.advance() == StitchPhase::extraction);
  CHECK(h.reward<rl::StitchFinished>() == 0.0);
  CHECK(h.reward<rl::ExitReached>() == 0.0);
  h.place_on_path(h.scene.path().angle + 0.53);
  h.tip_is(TipState::inside);  // out far enough by its angle, but somewhere in tissue
  CHECK(h.advance() == StitchPhase::extraction);
  h.tip_is(TipState::outside);
  CHECK(h.advance() == StitchPhase::finished);
  CHECK(h.reward<rl::StitchFinished>() == weights.finished);
  CHECK(rl::StitchOver::holds(h.env(), h.context()));
}

TEST_CASE("an exit elsewhere loses the stitch", "[rl][suturing][reward]") {
  Hand h;
  h.raise(EventKind::entry, 0.0);
  h.advance();
  h.decide();
  h.raise(EventKind::exit, 0.2);
  CHECK(h.advance() == StitchPhase::lost);
  CHECK(h.reward<rl::ExitReached>() == 0.0);
}

TEST_CASE("milestones of one decision are all paid for", "[rl][suturing][reward]") {
  Hand h;
  auto const weights = h.envs.config().reward;
  h.decide();
  h.raise(EventKind::entry, 0.0);
  h.raise(EventKind::exit, 0.0);
  h.place_on_path(h.scene.path().angle + 0.6);
  CHECK(h.advance() == StitchPhase::finished);
  CHECK(h.reward<rl::EntryReached>() == weights.entry_reached);
  CHECK(h.reward<rl::ExitReached>() == weights.exit_reached);
  CHECK(h.reward<rl::StitchFinished>() == weights.finished);
  h.decide();
  h.advance();
  CHECK(h.reward<rl::StitchFinished>() == 0.0);  // once
}

TEST_CASE("what was reached is paid for though the stitch is lost at once",
          "[rl][suturing][reward]") {
  Hand h;
  h.decide();
  h.raise(EventKind::entry, 0.0);
  h.raise(EventKind::exit, 0.2);
  CHECK(h.advance() == StitchPhase::lost);
  CHECK(h.reward<rl::EntryReached>() == h.envs.config().reward.entry_reached);
  CHECK(h.reward<rl::ExitReached>() == 0.0);
}

TEST_CASE("a puncture after the exit loses the stitch", "[rl][suturing][reward]") {
  Hand h;
  h.raise(EventKind::entry, 0.0);
  h.raise(EventKind::exit, 0.0);
  REQUIRE(h.advance() == StitchPhase::extraction);
  h.decide();
  h.raise(EventKind::entry, 0.0);
  h.place_on_path(h.scene.path().angle + 0.6);
  CHECK(h.advance() == StitchPhase::lost);
  CHECK(h.reward<rl::StitchFinished>() == 0.0);
}

TEST_CASE("episodes differ in everything that they may differ in",
          "[rl][suturing][randomisation]") {
  auto const c = test::suturing_config("coarse.toml");
  Envs envs(c, {.num_envs = 1, .seed = 8});
  auto const& state = envs.simulation().state();
  auto numbers = [&] {
    auto const context = envs.simulation().context(0);
    auto const pose = state.get<needle::Position>(0, 0);
    auto const turn = state.get<needle::Orientation>(0, 0);
    auto const soft = context.of<NeoHookean>();
    return std::vector<double>{
        pose[0],
        pose[2],
        turn[0],
        context.of<ArcNeedle>().radius,
        soft.mu,
        soft.lambda / soft.mu,
        context.of<Friction>().coefficient,
        load_parameters<Bend>(
            access_environment(envs.simulation().state(), 0, typename Envs::Sim::Store::Domains{}),
            0)
            .compliance,
        envs.newest<rl::TipAndMarkers>(0)[3],
        double(envs.newest<rl::TipAndMarkers>(0)[6]) -
            double(envs.newest<rl::TipAndMarkers>(0)[3])};
  };
  envs.start(0, 1);
  auto least = numbers(), most = least;
  for (int k = 2; k <= 200; ++k) {
    envs.start(0, k);
    auto const now = numbers();
    for (std::size_t i = 0; i < now.size(); ++i) {
      least[i] = std::min(least[i], now[i]);
      most[i] = std::max(most[i], now[i]);
    }
  }
  // 200 even draws fill all but a twentieth of a range at each end.
  auto const& r = c.random;
  auto fills = [&](std::size_t i, double from, double to) {
    CAPTURE(i, least[i], most[i], from, to);
    double const slack = 0.05 * (to - from) + 1e-6;
    CHECK(least[i] >= from - 1e-6);
    CHECK(least[i] < from + slack);
    CHECK(most[i] <= to + 1e-6);
    CHECK(most[i] > to - slack);
  };
  auto const start = c.scene.script().start.position;
  auto const lame = c.scene.tissue.lame();
  fills(0, start[0] - r.shift, start[0] + r.shift);
  fills(1, start[2] + r.height - r.shift, start[2] + r.height + r.shift);
  fills(3, c.scene.needle.radius, c.scene.needle.radius * r.needle_radius);
  fills(4, lame.mu / r.modulus, lame.mu * r.modulus);
  fills(6, c.scene.contact.friction / r.friction, c.scene.contact.friction * r.friction);
  fills(8, c.scene.markers.entry[0] - r.marker_shift,
        c.scene.markers.entry[0] + r.marker_shift + r.marker_closer);
  fills(9, 0.6 - 2 * r.marker_closer, 0.6);
  for (std::size_t i : {std::size_t{2}, std::size_t{5}, std::size_t{7}})
    CHECK(most[i] > 1.02 * least[i]);
}
