// The stitch, preset paper: what `./scripts/demo.sh` shows, judged by the same report. Reduced to 3,456 of
// 20,000 material points; grid, needle, thread, motion and every limit are the preset's.
// seconds: 40
#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog/suturing_hand.hpp>
#include <mpmpbd/catalog/suturing_report.hpp>

#include "catch.hpp"
#include "support/presets.hpp"

using namespace mpmpbd;

namespace {

SuturingConfig reduced_paper() { return test::preset("paper", {"tissue.points = [24, 12, 12]"}); }

suturing::StitchReport stitch(SuturingConfig const& c, bool coupled) {
  Simulation<Suturing, Threads, float> sim(suturing::options(c));
  suturing::set_up(sim, 0, c);
  if (!coupled) suturing::uncouple(sim, 0);
  suturing::ScriptedHand const hand{c.script()};
  suturing::StitchReport report(c);
  double const h = c.time.step;
  for (int step = 0; step < c.steps(); ++step) {
    hand.command(sim, 0, step * h, h);
    sim.step(h);
    report.record(sim, 0, (step + 1) * h);
  }
  report.finish(sim, 0);
  return report;
}

bool holds(std::vector<suturing::Verdict> const& all, std::string const& name) {
  for (auto const& v : all)
    if (v.name == name) return v.holds;
  FAIL("no verdict of the name '" << name << "'");
  return false;
}

}  // namespace

TEST_CASE("a needle drives a thread through soft tissue", "[physics][stitch]") {
  auto const c = reduced_paper();
  auto const report = stitch(c, true);
  auto const verdicts = report.verdicts();
  REQUIRE(verdicts.size() == 12);
  for (auto const& v : verdicts) {
    INFO(v.name << ": " << v.finding);
    CHECK(v.holds);
  }
  // Where thread and needle hold the same tissue in different directions, at the swage, it is six times
  // as much (coupling/thread_blocks.hpp).
  CHECK(report.peak_force() < 1.5 * c.needle.puncture_force);
  CHECK(report.peak_tension() < c.needle.puncture_force);
}

TEST_CASE("without coupling it is not a stitch", "[physics][stitch]") {
  auto const verdicts = stitch(reduced_paper(), false).verdicts();
  for (auto const* name :
       {"entry hits its marker", "exit hits its marker", "no tissue force before touch",
        "puncture shows as a force drop", "dimple at puncture at most a cell",
        "peak needle force between puncture and 20 times as much", "at least 4 segments embedded",
        "each crossing within a cell of the needle's track",
        "tension while the thread is pulled"}) {
    INFO(name);
    CHECK_FALSE(holds(verdicts, name));
  }
  CHECK(holds(verdicts, "no fault"));
}
