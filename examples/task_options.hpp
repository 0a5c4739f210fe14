// What the programs about learning share: the command line, the settings of the suturing task,
// episodes and their table.
#pragma once

#include "cli.hpp"

#include <mpmpbd/catalog/suturing_task.hpp>
#include <mpmpbd/io/csv.hpp>
#include <mpmpbd/io/progress.hpp>
#if defined(COURSE_HAS_CUDA)
#include <mpmpbd/rl/cuda/vector_env.hpp>
#endif

namespace course {

namespace rl = mpmpbd::rl;

struct TaskOptions {
  rl::SuturingTaskConfig config;
  std::string preset = "coarse";
  std::vector<std::string> settings{};  // of the program itself; --config and --set come after them
  std::int64_t num_envs = 8;
  int episodes = 0;
  std::string counted = "episodes to run";
  std::int64_t seed = 1;
  mpmpbd::Threads threads;
  bool takes_devices = false;  // whether the program knows --device
  std::string device = "cpu";
  Path out;
  bool unfinished = false;  // too short for its results to be judged

  // Environments that wait after an episode for the next one that is handed to them.
  rl::VectorEnvOptions envs() const {
    return {.num_envs = num_envs, .seed = seed, .autoreset = rl::Autoreset::disabled};
  }
  std::string place() const {
    return device == "cpu" ? fmt::format("{} threads", threads.lanes()) : "a CUDA device";
  }
};

// Calls program(envs) with the environments of a task where the command line wants them.
template <class Task, class Program> bool with_envs(TaskOptions const& run, Program&& program) {
  if (run.device == "cuda") {
#if defined(COURSE_HAS_CUDA)
    rl::VectorEnv<Task, mpmpbd::Cuda> envs(run.config, run.envs());
    return program(envs);
#else
    throw std::runtime_error(
        "--device cuda asked for; this program was built without CUDA: configure with "
        "-DMPMPBD_CUDA=ON, or take --device cpu");
#endif
  }
  rl::VectorEnv<Task, mpmpbd::Threads> envs(run.config, run.envs(), run.threads);
  return program(envs);
}

namespace detail {
inline void read_task(TaskOptions& o, Path const& config, std::vector<std::string> const& lines) {
  auto const scenes = Path(__FILE__).parent_path() / "scenes";
  std::vector<mpmpbd::io::ConfigSource> sources;
  auto file = [&](Path const& path) {
    sources.push_back({mpmpbd::io::read_file(path), path.string()});
  };
  file(scenes / (o.preset + ".toml"));
  file(scenes / "suturing_task.toml");
  for (auto const& line : o.settings) sources.push_back({line, "the program"});
  if (!config.empty()) file(config);
  for (auto const& line : lines) sources.push_back({line, "--set"});
  o.config = mpmpbd::io::parse_config<rl::SuturingTaskConfig>(sources);
}
}  // namespace detail

// The main function: `program(options)` returns whether its own checks hold. Exit codes as of
// course::run.
template <class Program>
int run_task(int argc, char** argv, std::string const& about, TaskOptions o, Program&& program) {
  Path config;
  std::vector<std::string> lines;
  o.out = Path("out") / detail::program_name(argv[0]);
  CLI::App app(about);
  app.add_option("--preset", o.preset, "scene")
      ->check(CLI::IsMember({"coarse", "paper"}))
      ->capture_default_str();
  app.add_option("--num-envs", o.num_envs, "environments side by side")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--episodes", o.episodes, o.counted)
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  if (o.takes_devices)
    app.add_option("--device", o.device, "where environments live")
        ->check(CLI::IsMember({"cpu", "cuda"}))
        ->capture_default_str();
  app.add_flag("--unfinished", o.unfinished, "the run is too short for its results to be judged");
  detail::declare_common(app, o.seed, o.threads, o.out, config, lines);
  CLI11_PARSE(app, argc, argv);
  return detail::guarded([&] {
    detail::read_task(o, config, lines);
    if (app.count("--seed") == 0)
      o.seed = o.config.scene.seed;
    else
      o.config.scene.seed = o.seed;  // the settings that are left repeat the run
    return detail::leave_results(o.out, o.config, [&] {
      return program(static_cast<TaskOptions const&>(o)) || o.unfinished;
    });
  });
}

// Hands episodes to environments as they become free, so that which ones are run does not depend on
// how many environments there are. With `distinct`, their numbers begin anew after that many.
class EpisodeQueue {
 public:
  explicit EpisodeQueue(std::int64_t count, std::int64_t first = 1, std::int64_t distinct = 0)
      : count_(count), first_(first), distinct_(distinct > 0 ? distinct : count) {}

  // Before the first step and after each one: every environment that is free begins the next episode.
  template <class Envs> void refill(Envs& envs) {
    if (doing_.empty()) doing_.assign(static_cast<std::size_t>(envs.num_envs()), none);
    for (std::int64_t env = 0; env < envs.num_envs(); ++env) {
      auto& mine = doing_[static_cast<std::size_t>(env)];
      if (mine != none && !envs.outcome().done(env)) continue;
      finished_ += mine != none;
      mine = next_ < count_ ? next_++ : none;
      if (mine != none) envs.start(env, first_ + mine % distinct_, 0);
    }
  }
  bool done() const { return finished_ == count_; }
  std::int64_t finished() const { return finished_; }
  // The place of an environment's episode in the queue, 0 to count - 1.
  std::int64_t place(std::int64_t env) const { return doing_[static_cast<std::size_t>(env)]; }
  bool busy(std::int64_t env) const { return place(env) != none; }

 private:
  static constexpr std::int64_t none = -1;
  std::int64_t count_, first_, distinct_, next_ = 0, finished_ = 0;
  std::vector<std::int64_t> doing_{};
};

// How episodes went, one line each, and their sums. `Envs` has the metrics of the suturing task.
template <class Envs> class EpisodeTable {
 public:
  explicit EpisodeTable(Path const& file) : csv_(file, columns()) {}

  // Takes what ended in the last step.
  void take(Envs const& envs, EpisodeQueue const& queue) {
    auto const& out = envs.outcome();
    for (std::int64_t env = 0; env < envs.num_envs(); ++env) {
      if (!queue.busy(env) || !out.done(env)) continue;
      auto const i = static_cast<std::size_t>(env);
      double const entry = double(envs.template metric<rl::metric::EntryMiss>(env));
      double const exit = double(envs.template metric<rl::metric::ExitMiss>(env));
      double const success = double(envs.template metric<rl::metric::Success>(env));
      std::vector<double> row{
          double(envs.episode(env)), double(out.episode_length[i]), success, entry, exit,
          double(out.status[i])};
      for (int k = 0; k < Envs::term_count; ++k)
        row.push_back(double(out.returns[i * Envs::term_count + std::size_t(k)]));
      csv_.row(row);
      ++episodes_;
      successes_ += success > 0.5;
      entries_ += entry >= 0.0 && entry < envs.config().reach;
      diverged_ += out.diverged[i];
    }
  }
  int episodes() const { return episodes_; }
  int successes() const { return successes_; }
  int entries() const { return entries_; }
  int diverged() const { return diverged_; }
  void close() { csv_.close(); }

 private:
  static std::vector<mpmpbd::io::Csv::Column> columns() {
    std::vector<mpmpbd::io::Csv::Column> all{{"episode", "1"},   {"decisions", "1"},
                                             {"success", "1"},   {"entry miss", "m"},
                                             {"exit miss", "m"}, {"status", "bits"}};
    for (auto name : Envs::term_names()) all.push_back({std::string(name), "1"});
    return all;
  }
  mpmpbd::io::Csv csv_;
  int episodes_ = 0, successes_ = 0, entries_ = 0, diverged_ = 0;
};

}  // namespace course
