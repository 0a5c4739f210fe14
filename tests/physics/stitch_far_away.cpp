// B8: the stitch, and the same 4096 cells farther from the domain's origin.
// seconds: 60
#include "catch.hpp"

#include "physics/stitch_run.hpp"

using namespace mpmpbd;

// There positions are rounded 4096 times as coarsely. As in stitch_units, a shake of the start by that much tells what
// rounding may do to a whole stitch.
TEST_CASE("B8: a stitch is the same 4096 cells away", "[stability][translation]") {
  auto const here = test::preset("coarse");
  auto there = here;
  Vec3<double> const shift = vec(4096 * here.domain.cell_size, 0.0, 0.0);
  there.domain.size += shift;
  there.tissue.corner += shift;
  using Run = test::StitchRun<double>;
  Run a(suturing::options(here)), b(suturing::options(there)), shaken(suturing::options(here));
  suturing::set_up(a, 0, here);
  suturing::set_up(b, 0, there);
  shaken.restore(a.state());
  test::shake(shaken, epsilon<double> * shift[0]);
  suturing::ScriptedHand const hand{here.script()};
  double const h = here.time.step;
  int step = 0;
  for (int const last : {10, 300, 900}) {  // up to 60 % of the drive
    for (; step < last; ++step) {
      hand.command(a, 0, step * h, h);
      auto const twist = needle::twist(a.state().view<Needles>(), 0);
      needle::set_twist(b.state().view<Needles>(), 0, twist);
      needle::set_twist(shaken.state().view<Needles>(), 0, twist);
      for (Run* run : {&a, &b, &shaken}) run->step(h);
    }
    auto const far = test::StitchDifference::of(a, b, shift);
    auto const shake = test::StitchDifference::of(a, shaken);
    CAPTURE(last, far.tissue, far.strain, far.thread, far.force, far.tension, shake.tissue,
            shake.strain, shake.thread, shake.force, shake.tension);
    REQUIRE(a.status(0) == b.status(0));
    REQUIRE_FALSE(has(a.status(0), Fault::not_finite));
    if (last == 10) CHECK(far.most() < 1e-8);
    CHECK(far.tissue < 1e-9 + 10 * shake.tissue);
    CHECK(far.strain < 1e-9 + 10 * shake.strain);
    CHECK(far.thread < 1e-9 + 10 * shake.thread);
    CHECK(far.force < 1e-9 + 10 * shake.force);
    CHECK(far.tension < 1e-9 + 10 * shake.tension);
  }
}
