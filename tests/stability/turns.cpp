// B31: a needle that turns about its own axis, about its chord, and again and again about its centre, with an
// arc beyond half a circle.
// seconds: 20
#include "catch.hpp"
#include "physics/arc_in_gel.hpp"

using namespace test;

namespace {

double fastest(ArcInGel::Run const& run, std::int64_t particles) {
  double most = 0;
  for (std::int64_t p = 0; p < particles; ++p)
    most = std::max(most, norm(run.state().get<particle::Velocity>(0, p)));
  return most;
}

}  // namespace

// It has no radius that could grip, so the gel does not feel it. The needle is as straight as a tenth of a radian
// over its length: its middle lies beside its axis by an eightieth of that and goes round. Steps are short, as its
// far centre moves straight in each.
TEST_CASE("a needle that spins about its own axis hardly moves the gel", "[stability][B31]") {
  GelBlock const block{.high = {13, 11, 11}};
  double const length = 6 * gel_cell;
  Arc<double> const needle{10 * length, 0.1, 3e-4, 0.0};
  auto run = gel_scene<NeedleInGel<Friction>, double>(block, needle);
  run.set<Friction>({0.2, 2e3});
  auto const x = vec(1.0, 0.0, 0.0), y = vec(0.0, 1.0, 0.0);
  auto const tip = gel_cell * vec(11.13, 7.2, 6.9);
  double const step = 0.1 * gel_time(), spin = 1e-3 / step;
  auto const pose = straight_pose(needle, tip, x, y);
  auto const chord =
      direction(to_world(pose, needle.point(0)) - to_world(pose, needle.point(needle.length())));
  for (int s = 0; s < 200; ++s) {
    place_needle(run, 0, pose);
    drive_needle(run, 0, spin * cross(chord, pose.position - tip), spin * chord);
    run.step(step);
    CHECK(fastest(run, block.particles()) < spin * length / 40);
  }
  CHECK(run.status(0) == 0);
}

namespace {

// Energy of the gel, and what the needle has put into it, about an axis through a point of the needle's plane.
struct Turned {
  double energy = 0, work = 0;
  bool finite = true;
  std::uint32_t status = 0;
};

// Turns a half circle of three cells about its chord by so many cells of its middle's way.
Turned about_chord(double cells, double speed) {
  ArcInGel arc({.radius = 3, .angle = pi<double>});
  Turned t;
  double const step = 0.1 * gel_time(), v = speed * gel_shear_speed();
  for (int n = static_cast<int>(cells / (0.1 * speed)); n > 0; --n) {
    auto const pose = needle::pose(arc.run.state().view<Needles>(), 0);
    auto const chord = quaternion::rotate(
        pose.orientation, direction(arc.arc.point(0) - arc.arc.point(arc.arc.length())));
    auto const spin = v / arc.arc.radius * chord;  // through the centre: half a circle
    drive_needle(arc.run, 0, {}, spin);
    arc.run.step(step);
    t.work -= dot(arc.run.state().get<needle::Moment>(0, 0), spin) * step;
  }
  t.energy = gel_energy(arc.run, 0);
  t.finite = is_finite(t.energy);
  t.status = arc.run.status(0);
  return t;
}

}  // namespace

TEST_CASE("a needle that turns about its chord gives the gel no more than its work",
          "[stability][B31]") {
  for (double const speed : {0.1, 0.5}) {  // a full turn at the latter
    auto const t = about_chord(speed == 0.5 ? 19 : 3, speed);
    CAPTURE(speed, t.energy, t.work, t.energy / t.work);
    CHECK(t.finite);
    CHECK(t.work > 0);
    CHECK(t.energy <= (1 + 1e-3) * t.work);
    CHECK(t.status == 0);
  }
}

namespace {

// Friction per length at the arc's points, from the tip on [N/m]; its ends have the gel ahead and behind on them.
std::vector<double> friction_along(ArcInGel const& arc) {
  auto const& state = arc.run.state();
  auto const turned = state.get<needle::Orientation>(0, 0);
  auto const points = ArcPoints<double>::over(arc.arc, gel_cell);
  std::vector<double> all;
  for (int i = 0; i < points.count(); ++i) {
    auto const J = quaternion::rotate_back(turned, state.get<contact::Impulse>(0, i + 1));
    all.push_back(dot(J, arc.arc.tangent(points.s(i))) /
                  (state.get<environment::Dt>(0) * points.ds(i)));
  }
  return all;
}

}  // namespace

// Its local angle passes pi, and its way passes the start: nothing may jump.
TEST_CASE("an arc of 240 degrees turns and turns with the same force", "[stability][B31]") {
  ArcInGel arc({.radius = 3, .angle = 4.2, .speed = 0.3});
  double const around = 2 * pi<double> * 3;
  arc.turn(around);
  double least = 1e300, most = 0;
  for (int i = 0; i < 64; ++i) {
    arc.turn(around / 16);
    auto const f = arc.forces();
    least = std::min(least, f.moment);
    most = std::max(most, f.moment);
    auto const along = friction_along(arc);
    for (std::size_t q = 2; q + 2 < along.size(); ++q) {
      CAPTURE(i, q, along[q]);
      CHECK(std::abs((along[q - 1] + along[q + 1]) / (2 * along[q]) - 1) < 0.05);
    }
  }
  CAPTURE(least, most);
  CHECK(most - least < 0.05 * least);
  CHECK(arc.run.status(0) == 0);
  double const energy = gel_energy(arc.run, 0);
  arc.turn(around);
  CHECK(gel_energy(arc.run, 0) < 1.05 * energy);
}
