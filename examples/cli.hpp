// What the programs of the course share: the command line, settings from a file, the folder for
// results. An example hands its scene and its settings to `course::run` and gets them back filled in.
#pragma once

#include <CLI/CLI.hpp>

#include <cstdio>
#include <string>
#include <vector>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/io/config.hpp>
#include <mpmpbd/io/progress.hpp>
#include <mpmpbd/scene/plan.hpp>

namespace course {

using mpmpbd::io::Path;

// What every example understands.
template <class Settings> struct Run {
  Settings settings;        // of --config and --set
  int steps = 0;            // of --steps
  std::int64_t seed = 1;    // of --seed
  mpmpbd::Threads threads;  // of --threads
  Path out;                 // of --out; exists

  // "Falling: [####----]  50 % ...", to be updated with the steps that are done.
  mpmpbd::io::Progress progress(std::string const& label) const { return {steps, label}; }
};

// One line of a check: says it, and returns whether it holds.
inline bool check(bool holds, std::string const& what) {
  fmt::print("{}  {}\n", holds ? "ok    " : "FAILED", what);
  return holds;
}

namespace detail {

// The name of a program from its path.
inline std::string program_name(char const* path) { return Path(path).filename().string(); }

template <class Settings> struct Options {
  Run<Settings> run;
  Path config;
  std::vector<std::string> overrides;
  bool plan = false;
  bool print_config = false;
};

// The options that programs have in common.
inline void declare_common(CLI::App& app, std::int64_t& seed, mpmpbd::Threads& threads, Path& out,
                           Path& config, std::vector<std::string>& overrides) {
  app.add_option("--seed", seed, "seed of all random numbers")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--threads", threads.count, "threads, 0: as many as there are cores")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  app.add_option("--out", out, "folder for results")->capture_default_str();
  app.add_option("--config", config, "settings, a TOML file (--print-config shows its keys)");
  app.add_option("--set", overrides, "one setting, for example --set table.key=900")
      ->take_all()
      ->expected(1);
}

template <class Settings> void declare(CLI::App& app, Options<Settings>& o) {
  app.add_option("--steps", o.run.steps, "steps to take")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  declare_common(app, o.run.seed, o.run.threads, o.run.out, o.config, o.overrides);
  app.add_flag("--print-config", o.print_config, "print all settings as TOML and stop");
  app.add_flag("--plan", o.plan, "print what a substep does and what is stored, and stop");
}

// Runs `body`, which returns an exit code; what it throws is said, with exit code 2.
template <class Body> int guarded(Body&& body) {
  try {
    return body();
  } catch (std::exception const& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}

// Writes the settings, runs the program, says where its results are.
template <class Settings, class Program>
int leave_results(Path const& out, Settings const& settings, Program&& program) {
  std::filesystem::create_directories(out);
  mpmpbd::io::write_config(out / "config.toml", settings);
  bool const good = program();
  fmt::print("results in {}\n", out.string());
  return good ? 0 : 1;
}

}  // namespace detail

// The main function of an example: `program(run)` returns whether its own checks hold.
//
// Exit code 0: they do; 1: they do not; 2: the settings or the machine did not allow the run.
template <class Scene, class Settings, class T = float, class Program>
int run(int argc, char** argv, std::string const& about, int default_steps, Program&& program) {
  detail::Options<Settings> o;
  o.run.steps = default_steps;
  o.run.out = Path("out") / detail::program_name(argv[0]);
  CLI::App app(about);
  detail::declare(app, o);
  CLI11_PARSE(app, argc, argv);
  return detail::guarded([&] {
    std::vector<Path> files;
    if (!o.config.empty()) files.push_back(o.config);
    o.run.settings = mpmpbd::io::read_config<Settings>(files, o.overrides);
    if (o.print_config) {
      fmt::print("{}", mpmpbd::io::config_text(o.run.settings));
      return 0;
    }
    if (o.plan) {
      fmt::print("{}", mpmpbd::plan<Scene, mpmpbd::Threads, T>());
      return 0;
    }
    return detail::leave_results(o.run.out, o.run.settings,
                                 [&] { return program(static_cast<Run<Settings> const&>(o.run)); });
  });
}

}  // namespace course
