// 9. Learning without derivatives: the cross-entropy method finds a linear policy that brings the
// needle in.
//
// A policy is a matrix. In each generation many are drawn around the best so far and tried in the
// same few episodes; the best of them say where the next ones are drawn (Rubinstein 1999). Needs
// nothing but Eigen.
// test: --num-envs 4 --episodes 1 --set episode.limit=1 --unfinished
#include "task_options.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <numeric>

using namespace mpmpbd;

namespace {

// The first third of the suturing task: it is over when the needle has gone in, anywhere.
struct GoneIn {
  using Role = role::Termination;
  [[maybe_unused]] static constexpr FixedString name = "GoneIn";
  using Reads = Fields<rl::stitch::Phase>;
  using Writes = Fields<>;
  template <class Env, class Ctx> MPMPBD_HD static bool holds(Env const& env, Ctx const&) {
    return rl::stitch::phase(env) != rl::StitchPhase::insertion;
  }
};
struct InsertionTask
    : rl::SuturingWith<rl::NeedlePose, rl::TipAndMarkers, rl::StitchState, GoneIn> {};
using Envs = rl::VectorEnv<InsertionTask, Threads>;

constexpr int features = 8;
using Features = Eigen::Matrix<float, features, 1>;
using Policy = Eigen::Matrix<float, Envs::action_size, features>;
using Numbers = Eigen::VectorXd;  // a policy as a column

// What the policy multiplies: way to the entry marker and to the circle through both markers
// [tenths of a metre], direction of the tip, whether it touches, 1.
Features look(Envs const& envs, std::int64_t env) {
  auto const pose = envs.newest<rl::NeedlePose>(env);
  auto const places = envs.newest<rl::TipAndMarkers>(env);
  auto const state = envs.newest<rl::StitchState>(env);
  Vec3<float> const centre = vec(pose[0], pose[1], pose[2]),
                    tip = vec(places[0], places[1], places[2]);
  Vec3<float> const arm = direction(tip - centre);
  float const middle = 0.5f * (places[3] + places[6]);
  Features f;
  f << 10 * (places[3] - tip[0]), 10 * (places[5] - tip[2]), 10 * (middle - centre[0]),
      10 * (places[5] - centre[2]), arm[0], arm[2], state[3], 1.0f;
  return f;
}

struct Score {
  double mean_return = 0.0;
  int entered = 0;
};

// Tries policies in the same episodes, as many at a time as there are environments.
class Trial {
 public:
  Trial(course::TaskOptions const& run, int episodes)
      : envs_(run.config, run.envs(), run.threads),
        actions_(static_cast<std::size_t>(envs_.num_envs() * Envs::action_size)),
        episodes_(episodes) {}

  std::vector<Score> run(std::vector<Numbers> const& policies, std::int64_t first_episode) {
    std::vector<Score> scores(policies.size());
    course::EpisodeQueue queue(std::int64_t(policies.size()) * episodes_, first_episode, episodes_);
    for (queue.refill(envs_); !queue.done(); queue.refill(envs_)) {
      for (std::int64_t env = 0; env < envs_.num_envs(); ++env)
        if (queue.busy(env)) decide(policies[policy(queue, env)], env);
      auto const& out = envs_.step(actions_);
      for (std::int64_t env = 0; env < envs_.num_envs(); ++env) {
        if (!queue.busy(env)) continue;
        Score& s = scores[policy(queue, env)];
        s.mean_return += double(out.reward[std::size_t(env)]) / episodes_;
        auto const phase = rl::StitchPhase(int(envs_.metric<rl::metric::Phase>(env)));
        s.entered += out.done(env) && phase == rl::StitchPhase::driving;
      }
    }
    return scores;
  }

 private:
  // All episodes of a policy come one after another.
  std::size_t policy(course::EpisodeQueue const& queue, std::int64_t env) const {
    return std::size_t(queue.place(env) / episodes_);
  }
  void decide(Numbers const& numbers, std::int64_t env) {
    Policy const policy = numbers.cast<float>().reshaped(Envs::action_size, features);
    Eigen::Map<Eigen::Vector3f>(actions_.data() + env * Envs::action_size) =
        (policy * look(envs_, env)).array().tanh();
  }

  Envs envs_;
  std::vector<float> actions_;
  int episodes_;
};

// Where policies are drawn: numbers independent of each other, each with its mean and spread.
struct Search {
  Numbers mean = Numbers::Zero(Envs::action_size * features);
  Numbers spread = Numbers::Constant(Envs::action_size * features, 0.5);

  Numbers draw(rl::Random& random) const {
    Numbers n = mean;
    for (Eigen::Index i = 0; i < n.size(); ++i) n[i] += spread[i] * normal(random);
    return n;
  }
  // Moves to the best ones; the spread keeps a floor that shrinks, so that it does not settle too
  // early.
  void update(std::vector<Numbers> const& best, double floor) {
    mean.setZero();
    for (auto const& n : best) mean += n / double(best.size());
    Numbers square = Numbers::Zero(mean.size());
    for (auto const& n : best) square += (n - mean).cwiseAbs2() / double(best.size());
    spread = (square.array().sqrt() + floor).matrix();
  }

 private:
  static double normal(rl::Random& random) {  // Box and Muller 1958
    double const radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
    return radius * std::cos(2.0 * pi<double> * random.uniform());
  }
};

constexpr int population = 32, elite = 6, tries = 3, exam = 100;

struct Generation {
  double best_return = 0.0, mean_return = 0.0, entered = 0.0,
         best_entered = 0.0;  // shares of tries
};

// Draws policies, tries them, and moves the search to the best.
Generation improve(Search& search, Trial& trial, rl::Random& random, int number) {
  std::vector<Numbers> policies{search.mean};
  while (static_cast<int>(policies.size()) < population) policies.push_back(search.draw(random));
  auto const scores = trial.run(policies, 1 + std::int64_t{number} * tries);
  std::vector<std::size_t> order(policies.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return scores[a].mean_return > scores[b].mean_return; });
  Generation g{.best_return = scores[order[0]].mean_return};
  std::vector<Numbers> best;
  for (int i = 0; i < population; ++i) {
    auto const k = order[static_cast<std::size_t>(i)];
    g.mean_return += scores[k].mean_return / population;
    g.entered += double(scores[k].entered) / (population * tries);
    if (i >= elite) continue;
    best.push_back(policies[k]);
    g.best_entered += double(scores[k].entered) / (elite * tries);
  }
  search.update(best, 0.3 * std::pow(0.85, number));
  return g;
}

bool learn(course::TaskOptions const& run) {
  Trial trial(run, tries);
  Search search;
  rl::Random random(run.seed, -1, 0);  // of no environment
  io::Csv curve(run.out / "learning.csv", {{"generation", "1"},
                                           {"time", "s"},
                                           {"best return", "1"},
                                           {"mean return", "1"},
                                           {"entered", "1"},
                                           {"best entered", "1"}});
  io::Progress progress(run.episodes, "learning", "generations");
  double const began = io::monotonic_seconds();
  for (int number = 1; number <= run.episodes; ++number) {
    auto const g = improve(search, trial, random, number);
    curve.row({double(number), io::monotonic_seconds() - began, g.best_return, g.mean_return,
               g.entered, g.best_entered});
    progress.update(number);
  }
  curve.close();
  double const seconds = io::monotonic_seconds() - began;
  auto const score = Trial(run, exam).run({search.mean}, std::int64_t{1} << 20);
  double const share = double(score[0].entered) / exam;
  fmt::print("learnt for {:.0f} s; entered in {:.0f} % of {} new episodes\n", seconds, 100 * share,
             exam);
  return course::check(share >= 0.8, "enters in at least 80 of 100 episodes");
}

}  // namespace

int main(int argc, char** argv) {
  course::TaskOptions defaults;
  defaults.episodes = 12;
  defaults.counted = "generations";
  defaults.settings = {"episode.limit=40"};  // who has not entered by then will not
  return course::run_task(argc, argv, "Learns to bring the needle in, without derivatives.",
                          defaults, learn);
}
