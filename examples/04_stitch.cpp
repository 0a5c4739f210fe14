// 4. The stitch: a scripted hand drives an arc needle through soft tissue and pulls the thread after it.
//
// Everything of the course at once, with numbers from a preset, and a verdict: the run fails unless it is
// a stitch. Try --no-coupling, which has to fail.
// test: --preset paper --steps 20 --no-video --unfinished
#include "stitch_files.hpp"
#include "stitch_options.hpp"

#include <mpmpbd/catalog/suturing_hand.hpp>

using namespace mpmpbd;
using Stitch = Simulation<Suturing, Threads, float>;

namespace {

struct Outcome {
  suturing::StitchReport report;
  std::vector<suturing::Moment> moments{};
  double seconds = 0.0;  // of computing, pictures not counted
  std::int64_t substeps = 0;
};

Outcome simulate(course::StitchOptions const& run, Stitch& sim, course::StitchFiles& files) {
  SuturingConfig const& c = run.config;
  Outcome out{suturing::StitchReport(c)};
  suturing::ScriptedHand const hand{c.script()};
  io::Progress progress(run.steps, "stitching");
  double const h = c.time.step;
  // Whether something that comes `rate` times a second comes in this step.
  auto comes = [h](double rate, int step) {
    auto number = [=](int n) { return std::floor(n * h * rate + 1e-6); };
    return number(step) > number(step - 1);
  };
  for (int step = 1; step <= run.steps; ++step) {
    double const begin = io::monotonic_seconds();
    hand.command(sim, 0, (step - 1) * h, h);
    sim.step(h);
    out.seconds += io::monotonic_seconds() - begin;
    out.report.record(sim, 0, step * h);
    out.substeps += out.report.last().substeps;
    files.row(sim, out.report.last());
    if (comes(c.output.frames_per_second, step))
      out.moments.push_back(suturing::Moment::of(sim, 0, step * h));
    if (comes(1.0 / c.output.snapshot_interval, step) || step == run.steps)
      files.snapshot(sim, step * h);
    progress.update(step);
  }
  out.report.finish(sim, 0);
  return out;
}

bool stitch(course::StitchOptions const& run) {
  SuturingConfig const& c = run.config;
  Stitch sim(suturing::options(c), run.threads);
  suturing::set_up(sim, 0, c);
  if (!run.coupled) suturing::uncouple(sim, 0);
  fmt::print("{} material points, {} beads, stable substep {:.3g} s, {} threads\n",
             c.tissue.point_count(), c.thread.beads, sim.suggest_dt(0), run.threads.lanes());

  course::StitchFiles files(run);
  auto const out = simulate(run, sim, files);
  files.finish(sim, out.report, out.seconds, out.substeps);
  if (run.video) files.draw(out.moments);

  bool good = true;
  for (auto const& v : out.report.verdicts()) {
    fmt::print("{}  {}: {}\n", v.holds ? "ok    " : "FAILED", v.name, v.finding);
    good = good && v.holds;
  }
  fmt::print("{:.1f} s of computing, {:.0f} steps/s, {:.3g} particle-substeps/s\n", out.seconds,
             run.steps / out.seconds,
             static_cast<double>(out.substeps) * c.tissue.point_count() / out.seconds);
  return good || run.unfinished;
}

}  // namespace

int main(int argc, char** argv) { return course::run_stitch(argc, argv, stitch); }
