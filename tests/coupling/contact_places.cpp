// What a needle has no contact points for is left out: its environment says so, and no other notices.
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/catalog.hpp>

#include "catch.hpp"
#include "cuda/compare.hpp"

using namespace mpmpbd;

namespace {

using Run = Simulation<Suturing, Serial, float>;
constexpr int steps = 20;

SuturingConfig config() {
  SuturingConfig c;
  c.tissue.points = {{24, 12, 12}};
  return c;
}
NeedleConfig larger(double factor) {
  auto needle = config().needle;
  needle.radius *= factor;
  return needle;
}
// The needle hangs in the air, the thread falls on the tissue. Environment 0 has a needle `factor` times as large.
Run falling(std::int64_t environments, double factor) {
  Run run(suturing::options(config(), environments));
  for (std::int64_t env = 0; env < environments; ++env) suturing::set_up(run, env, config());
  run.set<ArcNeedle>(0, larger(factor).parameters());
  for (int s = 0; s < steps; ++s) run.step(config().time.step);
  return run;
}

std::vector<Vec3<float>> beads_of(Run const& run) {  // positions and velocities
  std::vector<Vec3<float>> all;
  for (std::int64_t b = 0; b < run.state().table<Beads>().live(0); ++b) {
    all.push_back(run.state().get<bead::Position>(0, b));
    all.push_back(run.state().get<bead::Velocity>(0, b));
  }
  return all;
}

}  // namespace

TEST_CASE("a needle that outgrows its contact points loses its blunt end alone",
          "[coupling][capacity]") {
  auto const alone = falling(1, 1.0), beside = falling(2, 2.0);
  CHECK_FALSE(has(alone.status(0), Fault::overflow));
  CHECK(has(beside.status(0), Fault::overflow));
  CHECK_FALSE(has(beside.status(0), Fault::not_finite));
  CHECK_FALSE(has(beside.status(1), Fault::overflow));
  CHECK(test::same_bits(beside.state(), 1, alone.state(), 0));
}

// Its constraints, and what ties it to the needle, still name its beads.
TEST_CASE("a thread without contact points stays where it is, and the needle goes on",
          "[coupling][capacity]") {
  auto options = suturing::options(config());
  for (Capacity& c : options.capacity)
    if (c.domain == ContactPoints::name.view()) c.slots = 4;
  Run run(options);
  suturing::set_up(run, 0, config());
  auto const thread_before = beads_of(run);
  auto const needle_before = run.state().get<needle::Position>(0, 0);
  run.state().set<needle::LinearVelocity>(0, 0, {{0.01f, 0.0f, 0.0f}});
  for (int s = 0; s < steps; ++s) run.step(config().time.step);
  CHECK(has(run.status(0), Fault::overflow));
  CHECK_FALSE(has(run.status(0), Fault::not_finite));
  CHECK(beads_of(run) == thread_before);
  float const moved = run.state().get<needle::Position>(0, 0)[0] - needle_before[0];
  CHECK(moved == Approx(0.01 * steps * config().time.step).epsilon(0.01));
}

TEST_CASE("a surface without triangles is met by nobody", "[coupling][surface]") {
  Run run(suturing::options(config()));
  suturing::set_up(run, 0, config());
  suturing::uncouple(run, 0);
  for (int s = 0; s < steps; ++s) run.step(config().time.step);
  CHECK(run.status(0) == 0);
  for (std::int64_t p = 0; p < run.state().table<ContactPoints>().live(0); ++p)
    REQUIRE(norm(run.state().get<contact::Impulse>(0, p)) == 0.0f);
}

TEST_CASE("what has no place among contact points is left out from the end",
          "[coupling][capacity]") {
  auto const fitted = [](std::int64_t places) {
    BodyCounts n{.beads = 5, .needle_points = 4, .attached_points = 2};
    n.fit(places);
    return n;
  };
  for (std::int64_t places = 0; places < 14; ++places) {
    auto const n = fitted(places);
    CHECK(n.exchange().points() <= places);
    CHECK(n.overflow == (places < 11));
    CHECK(n.beads == (places < 5 ? 0 : 5));
    if (n.beads == 0) CHECK(n.attached_points == 0);  // they are attached to the thread
    CHECK(n.needle_points == (places < 5 ? std::min<int>(4, static_cast<int>(places))
                                         : std::min<int>(4, static_cast<int>(places) - 5)));
  }
  BodyCounts lone{.beads = 1, .attached_points = 1};  // attachments are places on a segment
  lone.fit(10);
  CHECK(lone.attached_points == 0);
  CHECK(lone.overflow);
}
