// The step loop on a GPU, driven by plain C++: it gives what the host's gives, the same bits in any company and for any
// number of threads, and an expert that sees through it alone sews.
//
// An argument names the folder of the scenes, where it is not that of the sources. With one more the bits of environments in
// company are compared for a decision, and that is all: for compute-sanitizer. tests/cuda has the same on an emulated device,
// and more of it.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <mpmpbd/catalog/suturing_task.hpp>
#include <mpmpbd/io/config.hpp>
#include <mpmpbd/rl/cuda/vector_env.hpp>
#include <mpmpbd/rl/suturing/expert.hpp>
#include <mpmpbd/testing/worst.hpp>

#include "cuda/fixed_point_noise.hpp"
#include "device/report.hpp"
#include "rl/sewn.hpp"
#include "support/scenes.hpp"

namespace {

using namespace mpmpbd;
using rl::SuturingTask;
using test::check;
using OnHost = rl::VectorEnv<SuturingTask, Threads>;
using OnDevice = rl::VectorEnv<SuturingTask, Cuda>;

rl::SuturingTaskConfig settings(io::Path const& scenes, std::vector<std::string> const& more) {
  return io::read_config<rl::SuturingTaskConfig>(
      std::vector<io::Path>{scenes / "coarse.toml", scenes / "suturing_task.toml"}, more);
}

// What an environment does depends on its number in the larger set, ...
template <class Envs> std::vector<float> actions(Envs const& envs, int decision) {
  std::vector<float> all;
  for (std::int64_t e = 0; e < envs.num_envs(); ++e)
    for (int a = 0; a < 3; ++a) {
      auto const n = double(e + envs.options().first_environment);
      all.push_back(float(std::sin(0.7 * decision + 1.3 * n + 2.1 * a)));
    }
  return all;
}

// ... or does not.
std::vector<float> actions_alike(OnDevice const& envs, int decision) {
  return std::vector<float>(std::size_t(3 * envs.num_envs()), float(std::sin(0.7 * decision)));
}

template <class Group> double difference(OnDevice const& a, OnHost const& b) {
  auto const x = a.observation<Group>(), y = b.observation<Group>();
  testing::Worst worst;
  for (std::size_t i = 0; i < y.size(); ++i) worst.include(std::fabs(double(x[i]) - double(y[i])));
  return worst.value();
}
// As the tests on an emulated device allow for fixed point [m], and eight roundings of a position of up to 2 m per step
// for other arithmetic.
double rounding(rl::SuturingTaskConfig const& c) {
  auto const& time = c.scene.time;
  double const steps = c.episode.decision_interval * c.episode.limit;
  double const v = test::fixed_point_noise(c.scene.domain.cell_size, time.step / time.substeps,
                                           time.substeps * steps);
  return v * steps * time.step + 8 * steps * 0x1p-23;
}

void compare_with_host(rl::SuturingTaskConfig const& c, rl::Autoreset how) {
  rl::VectorEnvOptions const options{.num_envs = 6, .seed = 5, .autoreset = how};
  OnHost host(c, options);
  OnDevice device(c, options);
  bool same = true;
  testing::Worst pose, markers;
  for (int i = 0; i < 7; ++i) {
    auto act = actions(host, i);
    if (i == 1) act[5] = 2.0f;
    auto const& h = host.step(act);
    auto const& d = device.step(act);
    same = same && d.terminated == h.terminated && d.truncated == h.truncated &&
           d.invalid_action == h.invalid_action && d.restarted == h.restarted &&
           d.episode_length == h.episode_length && d.status == h.status;
    pose.include(difference<rl::NeedlePose>(device, host));
    markers.include(difference<rl::TipAndMarkers>(device, host));
  }
  check(same, "episodes end and begin as on the host", double(how));
  check(pose.value() < rounding(c), "the needle is where it is on the host [m]", pose.value());
  check(markers.value() < rounding(c), "and tip and markers [m]", markers.value());
}

// Everything that an environment shows and is paid over some decisions.
std::vector<float> record(OnDevice& envs, std::int64_t env, int decisions,
                          std::vector<float> (*act)(OnDevice const&, int) = actions) {
  std::vector<float> all;
  auto const append = [&](auto const& numbers) {
    auto const n = std::ptrdiff_t(numbers.size()) / envs.num_envs();
    all.insert(all.end(), numbers.begin() + env * n, numbers.begin() + (env + 1) * n);
  };
  for (int i = 0; i < decisions; ++i) {
    auto const& out = envs.step(act(envs, i));
    append(out.terms);
    append(out.returns);
    append(out.metrics);
    append(envs.observation<rl::NeedlePose>());
    append(envs.observation<rl::TipAndMarkers>());
    append(envs.observation<rl::ThreadTension>());
  }
  return all;
}
bool same_bits(std::vector<float> const& a, std::vector<float> const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
}
void compare_companies(rl::SuturingTaskConfig const& c, int decisions) {
  OnDevice many(c, {.num_envs = 200, .seed = 3}), again(c, {.num_envs = 200, .seed = 3}),
      narrow(c, {.num_envs = 200, .seed = 3}, Cuda{.threads = 256}),
      tiled(c, {.num_envs = 200, .seed = 3}, Cuda{.execution = Cuda::Execution::tiled}),
      alone(c, {.num_envs = 1, .seed = 3, .first_environment = 137});
  auto const first = record(many, 137, decisions);
  check(same_bits(first, record(again, 137, decisions)), "the same again");
  check(same_bits(first, record(narrow, 137, decisions)), "256 threads give the same bits");
  check(same_bits(first, record(alone, 0, decisions)), "alone it has the same bits");
  check(same_bits(first, record(tiled, 137, decisions)),
        "and with launches of their own for every step");
  // Its second episode again, in another's place; the one after it is this place's own.
  many.start(0, 2, 137);
  alone.start(0, 2);
  int const of_episode = std::min(decisions, c.episode.limit - 1);
  check(same_bits(record(many, 0, of_episode, actions_alike),
                  record(alone, 0, of_episode, actions_alike)),
        "an episode is the same in another's place");
}

void sew(rl::SuturingTaskConfig const& c) {
  OnDevice envs(c, {.num_envs = 8, .seed = 1, .autoreset = rl::Autoreset::disabled});
  rl::SuturingExperts experts(envs);
  for (int i = 0; i < c.episode.limit; ++i) envs.step(experts.act(envs));
  int stitches = 0;
  for (std::int64_t e = 0; e < 8; ++e) stitches += envs.metric<rl::metric::Success>(e) > 0.5f;
  check(stitches == 8, "stitches of eight by the expert", stitches);
}

// Not the thread's tension: at no more than 9 N, a strain of 3e-6, it is made of the rounding of positions in float.
void compare_stitches(rl::SuturingTaskConfig const& c) {
  rl::VectorEnvOptions const options{.num_envs = 1, .autoreset = rl::Autoreset::disabled};
  auto const host = test::sew(OnHost(c, options)), device = test::sew(OnDevice(c, options));
  check(host.phase == std::int64_t(rl::StitchPhase::finished) && host.events.size() >= 2,
        "the expert sews on the host", double(host.events.size()));
  check(device.events == host.events, "on a device with the same events",
        double(device.events.size()));
  check(device.phase == host.phase && device.decisions == host.decisions &&
            device.status == host.status,
        "in as many decisions, with the same status", device.decisions);
  check(std::fabs(device.entry_miss - host.entry_miss) < 0.01 * c.reach &&
            std::fabs(device.exit_miss - host.exit_miss) < 0.01 * c.reach,
        "and it goes in and out at the same places [m]", device.exit_miss - host.exit_miss);
  double const off = std::fabs(device.force / host.force - 1.0);
  check(off < 0.01, "the largest force on the needle is the host's within 1 %", off);
}

}  // namespace

int main(int argc, char** argv) {
  auto const scenes = argc > 1 ? io::Path(argv[1]) : test::scenes();
  auto const brief =
      settings(scenes, {"episode.decision_interval=5", "episode.limit=3", "episode.frames=2"});
  compare_companies(brief, argc > 2 ? 1 : 7);
  if (argc > 2) return test::report.end();
  for (auto how : {rl::Autoreset::same_step, rl::Autoreset::next_step, rl::Autoreset::disabled})
    compare_with_host(brief, how);
  auto const whole = settings(scenes, {});
  sew(whole);
  compare_stitches(whole);
  return test::report.end();
}
