// What a step of the suturing scene costs on a CUDA device: 20,000 particles, a needle in tissue, a thread of 20 beads.
//
// Rows of CSV, a step's mean and standard deviation over five blocks of steps. `contents` says what moves: `tissue` alone;
// `apart`, needle and thread too, which do not meet it (there is no surface); `contact`, all of it. `faults`: those that any
// environment has met.
//
// Usage: bench_device_throughput TABLE... [resident|tiled] [threads=512] [tissue] [apart] [contact] [ENVIRONMENTS...]
//
// environments  2 and 4 substeps, each of the contents (or those named), for as many environments
// bodies        one environment with larger blocks of tissue; needle and thread apart
// small         a few environments with smaller blocks of tissue and nothing else
// streams       ten environments, dealt out to 1, 2, 4 and 10 runs with a stream each
// moved         in contact: needles are moved at random, and a hundredth of the environments begins anew, each step
// moved_body    so is the largest of the bodies
// devices       so many environments (1,056) on each device that there is: on one, then on all at once
// decisions     the step loop of the suturing task, moved at random: a step is a decision, 20 steps of 4 substeps
// threads       threads of 100 beads without tissue, hung up at one end: steps of 0.002 s, 2 substeps; `particles` are beads
#include <cuda_runtime_api.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/backend/cuda/memory.cuh>
#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog.hpp>
#include <mpmpbd/catalog/suturing_hand.hpp>
#include <mpmpbd/catalog/suturing_task.hpp>
#include <mpmpbd/pbd/rod_builder.hpp>
#include <mpmpbd/rl/cuda/vector_env.hpp>

namespace {

using namespace mpmpbd;

using OnHost = Simulation<Suturing, Threads, float>;
using OnDevice = Simulation<Suturing, Cuda, float>;

// The paper's step sits at the stable limit at a density of 1000; with 4000 two substeps are legal.
// `scale`: of the block's edges, with as many particles per cell.
SuturingConfig config(int substeps, double scale = 1.0) {
  SuturingConfig c;
  for (int a = 0; a < 3; ++a) {
    double const spacing = c.tissue.spacing()[a];
    c.tissue.points[a] = static_cast<int>(std::lround(scale * c.tissue.points[a]));
    c.tissue.size[a] = spacing * c.tissue.points[a];
    c.domain.size[a] =
        c.domain.cell_size * (std::ceil(c.tissue.size[a] / c.domain.cell_size - 1e-6) + 5.0);
  }
  c.tissue.corner = {{0.25, 0.25, 0.25}};
  c.tissue.density = substeps == 2 ? 4000.0 : 1000.0;
  c.time.substeps = substeps;
  return c;
}

enum class Contents { tissue, apart, contact };
constexpr char const* names[] = {"tissue", "apart", "contact"};
constexpr Contents all_contents[] = {Contents::tissue, Contents::apart, Contents::contact};

// One environment after `steps` of the scripted stitch.
OnHost stitch(SuturingConfig const& c, int steps, Contents contents) {
  OnHost run(suturing::options(c));
  suturing::set_up(run, 0, c);
  if (contents != Contents::contact) suturing::uncouple(run, 0);
  if (contents == Contents::tissue) {
    run.state().table<Needles>().set_live(0, 0);
    run.state().table<Beads>().set_live(0, 0);
    run.state().table<Instances<Swage>>().set_live(0, 0);
    return run;
  }
  suturing::ScriptedHand const hand{c.script()};
  double const h = c.time.step;
  for (int s = 0; s < steps; ++s) {
    hand.command(run, 0, s * h, h);
    run.step(h);
  }
  return run;
}

struct Milliseconds {
  double mean, deviation;
};

// Of step(), repeated; `wait` returns when the devices are done.
Milliseconds time_of(int steps, std::function<void()> const& step,
                     std::function<void()> const& wait) {
  constexpr int blocks = 5;
  Milliseconds m{0.0, 0.0};
  std::vector<double> ms;
  for (int b = 0; b < blocks; ++b) {
    auto const begun = std::chrono::steady_clock::now();
    for (int s = 0; s < steps; ++s) step();
    wait();
    std::chrono::duration<double, std::milli> const took = std::chrono::steady_clock::now() - begun;
    ms.push_back(took.count() / steps);
    m.mean += ms.back() / blocks;
  }
  for (double t : ms) m.deviation += (t - m.mean) * (t - m.mean) / blocks;
  m.deviation = std::sqrt(m.deviation);
  return m;
}

// What is measured, by one run or several at once.
struct Case {
  char const* table;
  SuturingConfig const& config;
  OnHost const& start;
  Contents contents;
};
struct Place {
  Cuda where;
  std::int64_t environments;
};

// What a run moves in a step.
struct Load {
  std::int64_t environments, particles, substeps;  // of one environment
  double density;
  char const* contents;
};
Load load(SuturingConfig const& c, Contents contents, std::int64_t environments) {
  return {environments, c.tissue.point_count(), c.time.substeps, c.tissue.density,
          names[static_cast<int>(contents)]};
}
// Names, with a + between them.
std::string faults(std::uint32_t status) {
  std::string met;
  for (auto const& f : fault_table)
    if (has(status, f.fault)) met += (met.empty() ? "" : "+") + std::string(f.name);
  return met;
}
void print(char const* table, char const* form, std::size_t runs, int devices, Load const& of,
           int steps, Milliseconds const& m, std::uint32_t status) {
  auto const particle_substeps =
      static_cast<double>(of.environments * of.particles * of.substeps * steps);
  std::printf("%s,%s,%zu,%d,%lld,%lld,%lld,%.0f,%s,%.4f,%.4f,%.4f,%s\n", table, form, runs, devices,
              static_cast<long long>(of.environments), static_cast<long long>(of.particles),
              static_cast<long long>(of.substeps), of.density, of.contents, m.mean, m.deviation,
              1e6 * m.mean / particle_substeps, faults(status).c_str());
  std::fflush(stdout);
}

void check(cudaError_t error) {
  if (error == cudaSuccess) return;
  std::fprintf(stderr, "%s\n", cudaGetErrorString(error));
  std::exit(1);
}

template <class Run> std::uint32_t status_of_all(Run const& run) {
  std::uint32_t status = 0;
  for (std::int64_t env = 0; env < run.environments(); ++env) status |= run.status(env);
  return status;
}

// Every environment, and what it returns to, as it is in `start`.
void fill(OnDevice& run, OnHost const& start) {
  for (std::int64_t env = 0; env < run.environments(); ++env)
    run.state().copy_environment(env, start.state(), 0);
  run.remember();
}

template <class Run> char const* form_of(Run const& run) {
  return run.execution().starts_with("resident") ? "resident" : "tiled";
}

// A run per place.
void measure(Case const& c, std::vector<Place> const& places, int devices = 1) {
  std::vector<OnDevice> runs;
  double const h = c.config.time.step;
  std::int64_t environments = 0;
  for (auto const& place : places) {
    OnDevice& run = runs.emplace_back(suturing::options(c.config, place.environments), place.where);
    fill(run, c.start);
    run.step_where(h, nullptr);  // the first launch loads the program
    run.reset();
    environments += place.environments;
  }
  auto const wait = [&] {
    for (auto& run : runs) run.wait();
  };
  wait();
  auto const step = [&] {
    for (auto& run : runs) run.step_where(h, nullptr);
  };
  auto const m = time_of(environments > 200 ? 4 : 20, step, wait);
  std::uint32_t status = 0;
  for (auto const& run : runs) status |= status_of_all(run);
  print(c.table, form_of(runs[0]), runs.size(), devices, load(c.config, c.contents, environments),
        1, m, status);
}

constexpr int steps_to_tissue = 400;

void environments(std::vector<std::int64_t> counts, std::vector<Contents> const& contents_of,
                  Cuda where) {
  if (counts.empty()) counts = {1, 10, 132, 264, 528, 1056, 2112, 4224};
  for (int substeps : {2, 4}) {
    auto const c = config(substeps);
    for (Contents contents : contents_of) {
      auto const start = stitch(c, steps_to_tissue, contents);
      for (auto n : counts) measure({"environments", c, start, contents}, {{where, n}});
    }
  }
}

constexpr double scale_of_4_million = 5.85;

// 20 and 160 thousand, 1.3 and 4 million particles, before the needle has come near.
void bodies(Cuda where) {
  for (double scale : {1.0, 2.0, 4.0, scale_of_4_million}) {
    auto const c = config(4, scale);
    measure({"bodies", c, stitch(c, 0, Contents::apart), Contents::apart}, {{where, 1}});
  }
}

// Environments of 576 to 10,240 particles.
void small(std::vector<std::int64_t> counts, Cuda where) {
  if (counts.empty()) counts = {1, 10, 40, 60};
  for (double scale : {0.3, 0.4, 0.5, 0.6, 0.8}) {
    auto const c = config(4, scale);
    auto const start = stitch(c, 0, Contents::tissue);
    for (auto n : counts) measure({"small", c, start, Contents::tissue}, {{where, n}});
  }
}

// What moves a run, in the memory of the device: drawn before anything is timed.
class Hands {
 public:
  // Twists in the plane of the suture, at most as fast as the hand of the step loop; and masks for resets.
  Hands(std::int64_t environments, rl::SuturingTaskConfig const& task)
      : environments_(static_cast<std::size_t>(environments)),
        twists_(6 * twist_sets * environments_ * sizeof(float)),
        masks_(mask_sets * environments_) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> share(-1.0f, 1.0f);
    auto const speed = static_cast<float>(task.hand.speed),
               rate = static_cast<float>(task.hand.turn_rate);
    std::vector<float> twists;  // (set, component, env): velocity [m/s], turn [rad/s]
    for (std::size_t set = 0; set < twist_sets; ++set)
      for (float largest : {speed, 0.0f, speed, 0.0f, rate, 0.0f})
        for (std::size_t e = 0; e < environments_; ++e) twists.push_back(largest * share(random));
    std::vector<unsigned char> masks(masks_.bytes());  // (set, env)
    for (auto& chosen : masks) chosen = random() % 100 == 0;
    cuda::copy(nullptr, twists_.as(), twists.data(), twists_.bytes(), cudaMemcpyHostToDevice);
    cuda::copy(nullptr, masks_.as(), masks.data(), masks_.bytes(), cudaMemcpyHostToDevice);
    check(cudaDeviceSynchronize());
  }

  // Every 20 steps needles move otherwise.
  void step(OnDevice& run, double h) {
    if (count_ % 20 == 0) {
      auto const* const twists = twists_.as<float>() + count_ / 20 % twist_sets * 6 * environments_;
      move<needle::LinearVelocity>(run, twists);
      move<needle::AngularVelocity>(run, twists + 3 * environments_);
    }
    run.reset_where(masks_.as<unsigned char>() + count_ % mask_sets * environments_);
    run.step_where(h, nullptr);
    ++count_;
  }

 private:
  static constexpr std::size_t twist_sets = 64, mask_sets = 1024;  // more than a case has steps for
  // There is a needle in an environment: the planes of its velocity follow one another.
  template <class Velocity> void move(OnDevice& run, float const* planes) const {
    cuda::copy(nullptr, run.array<Velocity>().data, planes, 3 * environments_ * sizeof(float),
               cudaMemcpyDeviceToDevice);
  }

  std::size_t environments_, count_ = 0;
  cuda::Memory twists_, masks_;
};

// Carries out the scripted stitch on the device, in one environment, which then returns to its end.
void sew(OnDevice& run, SuturingConfig const& c, int steps) {
  auto const script = c.script();
  double const h = c.time.step;
  for (int s = 0; s < steps; ++s) {
    auto const twist = script.twist(s * h, (s + 1) * h);
    auto const linear = cast<float>(twist.linear), angular = cast<float>(twist.angular);
    cuda::copy(nullptr, run.array<needle::LinearVelocity>().data, &linear, sizeof linear,
               cudaMemcpyHostToDevice);
    cuda::copy(nullptr, run.array<needle::AngularVelocity>().data, &angular, sizeof angular,
               cudaMemcpyHostToDevice);
    run.step_where(h, nullptr);
  }
  run.remember();
}

// Needles are moved as the hand of the step loop may; timed once environments differ. `sewn`: steps of the stitch that are
// still to be done.
void measure_moved(Case const& c, Place const& place, int sewn = 0) {
  auto const n = place.environments;
  OnDevice run(suturing::options(c.config, n), place.where);
  fill(run, c.start);
  if (sewn > 0) sew(run, c.config, sewn);
  Hands hands(n, {});
  auto const step = [&] { hands.step(run, c.config.time.step); };
  for (int s = 0; s < 200; ++s) step();
  run.wait();
  auto const m = time_of(n > 200 ? 40 : 100, step, [&] { run.wait(); });
  print(c.table, form_of(run), 1, 1, load(c.config, c.contents, n), 1, m, status_of_all(run));
}

void moved(std::vector<std::int64_t> counts, Cuda where) {
  if (counts.empty()) counts = {10, 132, 264, 528, 1056, 2112, 4224};
  for (int substeps : {2, 4}) {
    auto const c = config(substeps);
    auto const start = stitch(c, steps_to_tissue, Contents::contact);
    for (auto n : counts) measure_moved({"moved", c, start, Contents::contact}, {where, n});
  }
}

// The largest of `bodies`.
void moved_body(Cuda where) {
  auto const c = config(4, scale_of_4_million);
  measure_moved({"moved_body", c, stitch(c, 0, Contents::contact), Contents::contact}, {where, 1},
                steps_to_tissue);
}

void streams(Cuda where) {
  auto const c = config(2);
  for (Contents contents : all_contents) {
    auto const start = stitch(c, steps_to_tissue, contents);
    for (int n : {1, 2, 4, 10}) {
      std::vector<Place> places;
      for (int i = 0; i < n; ++i) {
        cudaStream_t stream{};
        check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
        places.push_back({where, (10 + i) / n});
        places.back().where.stream = stream;
      }
      measure({"streams", c, start, contents}, places);
      for (auto const& place : places)
        check(cudaStreamDestroy(static_cast<cudaStream_t>(place.where.stream)));
    }
  }
}

void devices(std::vector<std::int64_t> const& counts, Cuda where) {
  int there = 0;
  check(cudaGetDeviceCount(&there));
  auto const c = config(4);
  auto const start = stitch(c, steps_to_tissue, Contents::contact);
  std::vector<Place> places;
  for (int d = 0; d < there; ++d) {
    places.push_back({where, counts.empty() ? 1056 : counts[0]});
    places.back().where.device = d;
    if (d == 0 || d + 1 == there) measure({"devices", c, start, Contents::contact}, places, d + 1);
  }
}

void decisions(std::vector<std::int64_t> counts, Cuda where) {
  rl::SuturingTaskConfig c;
  c.scene = config(4);
  if (counts.empty()) counts = {1, 132, 1056};
  for (auto n : counts) {
    rl::VectorEnv<rl::SuturingTask, Cuda> envs(c, {.num_envs = n}, where);
    std::vector<float> actions(static_cast<std::size_t>(n) * rl::SuturingTask::Action::size);
    for (std::size_t i = 0; i < actions.size(); ++i)
      actions[i] = std::sin(12.9898f * static_cast<float>(i));
    envs.step(actions);  // which leaves them in envs.actions()
    auto const wait = [&] { std::as_const(envs).simulation().wait(); };
    wait();
    auto const m = time_of(
        2, [&] { envs.step_from(envs.actions()); }, wait);
    print("decisions", form_of(std::as_const(envs).simulation()), 1, 1,
          load(c.scene, Contents::contact, n), static_cast<int>(c.episode.decision_interval), m,
          status_of_all(std::as_const(envs).simulation()));
  }
}

void threads(std::vector<std::int64_t> counts, Cuda where) {
  using Scene = catalog::Suture;
  constexpr int beads = 100, substeps = 2;
  constexpr double length = 0.3, h = 2e-3;
  constexpr RodMaterial nylon{2e9, 1.15e-4, 1140.0};
  if (counts.empty()) counts = {1, 132, 1056, 4224};
  std::vector<Vec3<double>> const line{vec(0.0, 0.0, 0.0), vec(length, 0.0, 0.0)};
  for (auto n : counts) {
    SimulationOptions o;
    o.environments = n;
    o.capacity = {{"bead", beads}, {"Distance", beads}, {"Bend", beads}};
    o.substeps = substeps;
    Simulation<Scene, Cuda, float> run(o, where);
    RodAssembly<Scene::Rods> rod;
    add_thread(rod, std::span<Vec3<double> const>(line), beads, nylon);
    rod.prescribe(0);
    for (std::int64_t env = 0; env < n; ++env) rod.write(run.state(), env);
    run.set<Gravity>({{0.0, 0.0, -9.81}});
    run.step(h);
    run.wait();
    auto const m = time_of(
        20, [&] { run.step_where(h, nullptr); }, [&] { run.wait(); });
    print("threads", "alone", 1, 1, {n, beads, substeps, nylon.density, "thread"}, 1, m,
          status_of_all(run));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::int64_t> counts;
  std::vector<Contents> contents;
  std::vector<std::string> tables;
  Cuda where;
  for (int i = 1; i < argc; ++i) {
    std::string_view const word = argv[i];
    auto const* const name = std::find(std::begin(names), std::end(names), word);
    if (name != std::end(names))
      contents.push_back(static_cast<Contents>(name - std::begin(names)));
    else if (word == "resident")
      where.execution = Cuda::Execution::resident;
    else if (word == "tiled")
      where.execution = Cuda::Execution::tiled;
    else if (word.starts_with("threads="))
      where.threads = std::atoi(argv[i] + 8);
    else if (std::atoll(argv[i]) > 0)
      counts.push_back(std::atoll(argv[i]));
    else
      tables.emplace_back(word);
  }
  if (contents.empty()) contents.assign(std::begin(all_contents), std::end(all_contents));
  std::map<std::string, std::function<void()>> const known{
      {"environments", [&] { environments(counts, contents, where); }},
      {"bodies", [&] { bodies(where); }},
      {"small", [&] { small(counts, where); }},
      {"moved", [&] { moved(counts, where); }},
      {"moved_body", [&] { moved_body(where); }},
      {"streams", [&] { streams(where); }},
      {"devices", [&] { devices(counts, where); }},
      {"decisions", [&] { decisions(counts, where); }},
      {"threads", [&] { threads(counts, where); }}};
  for (auto const& table : tables)
    if (!known.contains(table)) {
      std::fprintf(
          stderr,
          "'%s' is no table: environments, bodies, small, moved, moved_body, streams, devices, decisions, "
          "threads\n",
          table.c_str());
      return 1;
    }
  std::puts(
      "table,form,runs,devices,environments,particles,substeps,density,contents,ms,deviation,ns,faults");
  for (auto const& table : tables) known.at(table)();
  return 0;
}
