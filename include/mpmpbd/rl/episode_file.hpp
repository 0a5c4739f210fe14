// Episodes in a file: HDF5 in the layout of robomimic, so that tools for imitation learning read it.
//
//   /data                      attributes: total, env_args (JSON)
//   /data/demo_0               attributes: num_samples, seed, environment, episode
//     actions (T, action_size), rewards (T), dones (T), terms (T, terms), obs/<group> (T, ...)
//
// obs[t] is the newest frame of what action[t] was chosen by; readers stack frames themselves. An
// episode is seen again exactly by VectorEnv::start(env, episode, environment) with the same seed,
// and the same actions.
#pragma once

#include <mpmpbd/io/hdf5.hpp>
#include <mpmpbd/rl/vector_env.hpp>

#if defined(MPMPBD_HAS_HDF5)

namespace mpmpbd::rl {

// Writes every episode that it has seen from its first decision to its end. Call before_step() with
// the observations that actions are chosen by, and after_step() with what came of them.
template <class Envs> class EpisodeWriter {
 public:
  using Groups = typename Envs::Task::Observations;

  // `arguments`: of the task, as JSON; robomimic builds its environments by them.
  EpisodeWriter(io::Path const& path, Envs const& envs, std::string const& name,
                std::string const& arguments = "{}")
      : file_(path), data_(file_.group("data")), open_(static_cast<std::size_t>(envs.num_envs())) {
    data_.attribute("env_args", "{\"env_name\": \"" + name +
                                    "\", \"type\": 2, \"env_kwargs\": " + arguments + "}");
  }

  void before_step(Envs const& envs, std::span<float const> actions) {
    for (std::int64_t env = 0; env < envs.num_envs(); ++env) {
      auto& now = open_[static_cast<std::size_t>(env)];
      if (envs.decisions(env) == 0 && !envs.waits(env)) now = Episode::begun(envs, env);
      now.acts = now.whole && !envs.waits(env);
      if (!now.acts) continue;
      append(now.actions, actions.subspan(static_cast<std::size_t>(env * Envs::action_size),
                                          std::size_t{Envs::action_size}));
      std::size_t k = 0;
      for_each_type(Groups{}, [&]<class Group>(std::type_identity<Group>) {
        append(now.groups[k++], std::as_bytes(envs.template newest<Group>(env)));
      });
    }
  }
  void after_step(Envs const& envs) {
    auto const& out = envs.outcome();
    for (std::size_t i = 0; i < open_.size(); ++i) {
      auto& now = open_[i];
      if (!now.acts) continue;
      now.rewards.push_back(out.reward[i]);
      append(now.terms, std::span(out.terms).subspan(i * Envs::term_count, Envs::term_count));
      if (!out.done(static_cast<std::int64_t>(i))) continue;
      write(envs, now);
      now = {};
    }
  }
  std::int64_t episodes() const { return episodes_; }
  // Gives the file its name; episodes that have not ended are left out.
  void close() {
    data_.attribute("total", samples_);
    { auto const done = std::move(data_); }
    file_.close();
  }

 private:
  struct Episode {
    std::int64_t seed = 0, environment = 0, episode = 0;
    bool whole = false;  // seen from its first decision on
    bool acts = false;   // in the present step
    std::vector<float> actions{}, rewards{}, terms{};
    std::vector<std::vector<std::byte>> groups{};

    static Episode begun(Envs const& envs, std::int64_t env) {
      return {.seed = envs.options().seed,
              .environment = envs.stream(env),
              .episode = envs.episode(env),
              .whole = true,
              .groups = std::vector<std::vector<std::byte>>(std::size_t{Groups::size})};
    }
  };

  template <class E, class Span> static void append(std::vector<E>& to, Span const& values) {
    to.insert(to.end(), values.begin(), values.end());
  }

  void write(Envs const& envs, Episode const& one) {
    auto demo = data_.group("demo_" + std::to_string(episodes_++));
    hsize_t const steps = one.rewards.size();
    demo.attribute("num_samples", static_cast<std::int64_t>(steps));
    demo.attribute("seed", one.seed);
    demo.attribute("environment", one.environment);
    demo.attribute("episode", one.episode);
    demo.template write<float>("actions", {steps, hsize_t{Envs::action_size}}, one.actions);
    demo.template write<float>("rewards", {steps}, one.rewards);
    demo.template write<float>("terms", {steps, hsize_t{Envs::term_count}}, one.terms);
    std::vector<std::int64_t> dones(one.rewards.size(), 0);
    dones.back() = 1;
    demo.template write<std::int64_t>("dones", {steps}, dones);
    auto obs = demo.group("obs");
    std::size_t k = 0;
    for_each_type(Groups{}, [&]<class Group>(std::type_identity<Group>) {
      using Element = typename detail::ElementOf<Group>::type;
      std::vector<hsize_t> shape{steps};
      for (auto n : envs.template shape<Group>()) shape.push_back(static_cast<hsize_t>(n));
      auto const& bytes = one.groups[k++];
      obs.template write<Element>(
          std::string(Group::name.view()), shape,
          {reinterpret_cast<Element const*>(bytes.data()), bytes.size() / sizeof(Element)});
    });
    samples_ += static_cast<std::int64_t>(steps);
  }

  io::Hdf5Writer file_;
  io::Hdf5Group data_;
  std::vector<Episode> open_;
  std::int64_t episodes_ = 0, samples_ = 0;
};

// One recorded episode: what is needed to see it again.
struct RecordedEpisode {
  std::int64_t seed, environment, episode;
  std::vector<float> actions, rewards;  // (T, action_size), (T)
};
// Throws io::FileError when there is none of this number, or its arrays do not fit together.
inline RecordedEpisode read_episode(io::Hdf5Reader const& file, std::int64_t number,
                                    int action_size) {
  auto const name = "demo_" + std::to_string(number);
  auto const demo = file.open("data").open(name);
  RecordedEpisode one{demo.integer("seed"), demo.integer("environment"), demo.integer("episode"),
                      demo.read<float>("actions"), demo.read<float>("rewards")};
  if (one.actions.size() != one.rewards.size() * static_cast<std::size_t>(action_size))
    throw io::FileError("'" + name + "' has " + std::to_string(one.actions.size()) +
                        " numbers of actions for " + std::to_string(one.rewards.size()) +
                        " decisions; there have to be " + std::to_string(action_size) +
                        " for each");
  return one;
}

}  // namespace mpmpbd::rl
#endif
