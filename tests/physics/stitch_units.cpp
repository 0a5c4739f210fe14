// B7: the stitch in metres, kilograms and seconds, and in millimetres, grams and milliseconds.
// seconds: 60
#include "catch.hpp"

#include "physics/stitch_run.hpp"
#include "support/unit_system.hpp"

using namespace mpmpbd;

namespace {

constexpr test::UnitSystem small{1e3, 1e3, 1e3};  // mm, g, ms

// Runs both side by side, the second with the motion that the hand gives the first.
template <class T> struct Both {
  SuturingConfig config = test::preset("coarse");
  test::StitchRun<T> metres{suturing::options(config)}, millimetres{told_small(config)};
  suturing::ScriptedHand hand{config.script()};

  Both() {
    suturing::set_up(metres, 0, config);
    millimetres.restore(metres.state());
    test::tell_in(small, millimetres.state());
  }
  static SimulationOptions told_small(SuturingConfig const& c) {
    auto o = suturing::options(c);
    o.cell_size *= small.length;
    return o;
  }
  // Other runs take the commands of the first.
  void run(int first, int last, std::vector<test::StitchRun<T>>& others) {
    double const h = config.time.step;
    for (int step = first; step < last; ++step) {
      hand.command(metres, 0, step * h, h);
      auto const twist = needle::twist(metres.state().template view<Needles>(), 0);
      needle::set_twist(
          millimetres.state().template view<Needles>(), 0,
          Twist<T>{T(small.of("m/s")) * twist.linear, T(small.of("rad/s")) * twist.angular});
      metres.step(h);
      millimetres.step(h * small.time);
      for (auto& other : others) {
        needle::set_twist(other.state().template view<Needles>(), 0, twist);
        other.step(h);
      }
    }
  }
  // What the second has come to, told in SI again.
  test::StitchRun<T> back() const {
    test::StitchRun<T> run(suturing::options(config));
    run.restore(millimetres.state());
    test::tell_in(small.inverse(), run.state());
    return run;
  }
};

}  // namespace

TEST_CASE("units are read as they are written", "[units]") {
  test::UnitSystem const u{2.0, 3.0, 5.0};
  CHECK(u.of("kg/m^3") == Approx(3.0 / 8.0));
  CHECK(u.of("N s/m^2") == Approx(3.0 * 2.0 / 25.0 * 5.0 / 4.0));
  CHECK(u.of("rad/(N m)") == Approx(25.0 / (3.0 * 4.0)));
  CHECK(u.of("Pa") == Approx(3.0 / (2.0 * 25.0)));
  CHECK(u.of("1/s") == Approx(0.2));
  CHECK(u.of("1") == 1.0);
  CHECK_THROWS(u.of("furlong"));
}

// Over a whole stitch rounding grows: a thread that swings and is drawn over tissue is a chaotic pendulum. So the
// specification's 1e-11 and 1e-5 are asked of the first steps, and later that other units change a stitch by no more than
// a shake of its start by a rounding error does, ten times as much at the most. So it is with tension from the start:
// it is EA times a strain, and rounding of a place x is a strain of epsilon x / l. In float one shake does not tell: at the
// end six of them moved the thread by 2e-5 to 2e-3 of its place, so the largest of several counts.
TEMPLATE_TEST_CASE("B7: a stitch is the same in metres and in millimetres", "[stability][units]",
                   double, float) {
  using T = TestType;
  Both<T> both;
  std::vector<test::StitchRun<T>> shaken;
  for (std::uint64_t seed = 3; seed < (sizeof(T) == 8 ? 4 : 8); ++seed) {
    auto& run = shaken.emplace_back(suturing::options(both.config));
    run.restore(both.metres.state());
    test::shake(run, double(epsilon<T>), seed);
  }
  double const allowed = sizeof(T) == 8 ? 1e-11 : 1e-5;
  int const steps = both.config.steps();
  for (auto const& [from, to] : {std::pair{0, 10}, {10, steps / 2}, {steps / 2, steps}}) {
    both.run(from, to, shaken);
    auto const units = test::StitchDifference::of(both.metres, both.back());
    test::StitchDifference shake{};
    for (auto const& run : shaken) shake.include(test::StitchDifference::of(both.metres, run));
    CAPTURE(to, units.tissue, units.strain, units.thread, units.force, units.tension, shake.tissue,
            shake.strain, shake.thread, shake.force, shake.tension);
    REQUIRE(both.metres.status(0) == both.millimetres.status(0));
    REQUIRE_FALSE(has(both.metres.status(0), Fault::not_finite));
    if (from == 0) {
      CHECK(units.tissue < allowed);
      CHECK(units.strain < allowed);
      CHECK(units.thread < allowed);
      CHECK(units.force < allowed);
    }
    CHECK(units.tissue < allowed + 10 * shake.tissue);
    CHECK(units.strain < allowed + 10 * shake.strain);
    CHECK(units.thread < allowed + 10 * shake.thread);
    CHECK(units.force < allowed + 10 * shake.force);
    CHECK(units.tension < allowed + 10 * shake.tension);
  }
  auto const events = [](auto& run) {
    return event_log(run.state().template view<Events>(), run.state().template view<Environments>(),
                     0)
        .count();
  };
  CHECK(events(both.metres) == events(both.millimetres));
  CHECK(events(both.metres) >= 2);  // in and out
}
