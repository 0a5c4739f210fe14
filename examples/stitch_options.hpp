// The command line of the stitch.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "cli.hpp"

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog/suturing_config.hpp>
#include <mpmpbd/io/config.hpp>

namespace course {

struct StitchOptions {
  mpmpbd::SuturingConfig config;
  std::string preset = "paper";
  int steps = 0;  // 0: the whole motion
  mpmpbd::Threads threads;
  mpmpbd::io::Path out;
  bool coupled = true;
  bool video = true;
  bool unfinished = false;
};

// A preset is one of the files beside the sources of the course.
inline mpmpbd::io::Path preset_file(std::string const& name) {
  return mpmpbd::io::Path(__FILE__).parent_path() / "scenes" / (name + ".toml");
}

// The main function: `program(options)` returns whether the stitch is one.
//
// Exit code 0: it is; 1: it is not; 2: the settings or the machine did not allow the run.
template <class Program> int run_stitch(int argc, char** argv, Program&& program) {
  StitchOptions o;
  mpmpbd::io::Path config;
  std::vector<std::string> overrides;
  std::int64_t seed = -1;
  bool no_coupling = false, no_video = false;
  CLI::App app("A needle drives a thread through soft tissue.");
  app.add_option("--preset", o.preset, "settings of the course")
      ->check(CLI::IsMember({"paper", "phantom"}))
      ->capture_default_str();
  app.add_option("--config", config, "settings, a TOML file, instead of a preset");
  app.add_option("--set", overrides, "one setting, for example --set needle.cutting_force_n=1500")
      ->take_all()
      ->expected(1);
  app.add_option("--steps", o.steps, "steps to take, 0: the whole motion")
      ->check(CLI::Range(0, 100000000));
  app.add_option("--seed", seed, "seed of all random numbers; nothing is random in the presets")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--threads", o.threads.count, "threads, 0: as many as there are cores")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  app.add_option("--out", o.out, "folder for results");
  app.add_flag("--no-coupling", no_coupling,
               "needle and thread pass through tissue; the verdict has to be no");
  app.add_flag("--no-video", no_video, "neither pictures nor video");
  app.add_flag("--unfinished", o.unfinished,
               "exit code 0 whatever the verdict, for a run of a few steps");
  CLI11_PARSE(app, argc, argv);
  return detail::guarded([&] {
    o.config = mpmpbd::io::read_config<mpmpbd::SuturingConfig>(
        config.empty() ? preset_file(o.preset) : config, overrides);
    if (seed >= 0) o.config.seed = seed;
    if (o.steps == 0) o.steps = o.config.steps();
    if (o.out.empty())
      o.out = mpmpbd::io::Path("out") / (config.empty() ? o.preset : config.stem().string());
    o.coupled = !no_coupling;
    o.video = !no_video;
    return detail::leave_results(o.out, o.config,
                                 [&] { return program(static_cast<StitchOptions const&>(o)); });
  });
}

}  // namespace course
