// Batches of the suturing scene on a GPU, driven by plain C++: a thousand different environments, of which one is lost,
// masks, checkpoints, a stream of the caller's and a graph captured from it.
//
// The last but one line tells the bits of four environments of each thousand: run_device.cmake compares those of two processes.
// With any argument a thousand are 200: for compute-sanitizer.
#include <cuda_runtime_api.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include <mpmpbd/catalog.hpp>
#include <mpmpbd/io/state_file.hpp>

#include "cuda/fixed_point_noise.hpp"
#include "cuda/suturing.hpp"
#include "device/report.hpp"

namespace {

using namespace test;

constexpr Cuda forms[] = {{.execution = Cuda::Execution::resident},
                          {.execution = Cuda::Execution::tiled}};
constexpr int steps = 2;

// All fields of the environments that have been looked at, in one number.
std::uint64_t seen = 0;
void see(OnDevice::Store const& state, std::int64_t env) {
  for (auto const row : rows_of(state, env))
    seen = seen * 31 + detail::fnv1a(row.data(), row.size());
}

// Environments that differ by how fast their thread is drawn.
void draw(OnDevice& run, std::int64_t env, std::int64_t as) {
  for (std::int64_t k = 0; k < config().thread.beads; ++k)
    run.state().set<bead::Velocity>(env, k, {{0.0f, 1e-4f * static_cast<float>(as), 0.0f}});
}
void drive(OnDevice& run) { test::drive(run, config(), steps_to_tissue, steps); }

void compare_many(Cuda where, std::int64_t many) {
  std::int64_t const lost = many / 2;
  auto batch = device_run(many, where);
  for (std::int64_t env = 0; env < many; ++env) draw(batch, env, env);
  batch.state().set<bead::Velocity>(lost, 7, {{std::numeric_limits<float>::quiet_NaN(), 0, 0}});
  auto const before = read(batch).get<particle::Position>(lost, 5);
  drive(batch);
  for (std::int64_t env : {std::int64_t{0}, lost - 1, lost + 1, many - 1}) {
    auto alone = device_run(1, where);
    draw(alone, 0, env);
    drive(alone);
    check(same_bits(read(alone), 0, read(batch), env), "of many, the bits of one alone",
          double(env));
    check(batch.status(env) == alone.status(0), "and its status", batch.status(env));
    see(read(batch), env);
  }
  check(!same_bits(read(batch), lost - 1, read(batch), lost + 1),
        "they are different environments");
  check(has(batch.status(lost), Fault::not_finite), "the one that is lost says so");
  check(read(batch).get<particle::Position>(lost, 5)[0] == before[0], "and stands still");
}

void mask_some(Cuda where) {
  auto run = device_run(3, where);
  run.remember();
  auto const start = read(run);
  std::vector<unsigned char> const middle{0, 1, 0};
  run.step(config().time.step, middle);
  check(same_bits(start, 0, read(run), 0) && same_bits(start, 2, read(run), 2),
        "a mask leaves the others where they are");
  check(!same_bits(start, 1, read(run), 1), "and moves what it names");
  run.step(config().time.step);
  auto const moved = read(run);
  run.reset(middle);
  auto back = read(run);
  check(same_bits(moved, 0, back, 0) && same_bits(moved, 2, back, 2), "a reset by mask as well");
  back.set<environment::Episode>(1, start.get<environment::Episode>(1));
  check(same_bits(start, 1, back, 1), "what is reset is what was remembered");
}

void go_on_from_a_file() {
  auto whole = device_run(2, forms[0]), first = device_run(2, forms[0]);
  draw(whole, 1, 70), draw(first, 1, 70);
  drive(whole), drive(first);
  auto const file = (std::filesystem::temp_directory_path() / "mpmpbd_device_batch.state").string();
  write_state_file(file, read(first));
  auto const kept = read_state_file<OnDevice::Store>(file);
  std::filesystem::remove(file);
  auto const c = config();
  OnDevice other(suturing::options(c, 2), forms[1]);
  OnHost host(suturing::options(c, 2));
  other.restore(kept), host.restore(kept);
  test::drive(whole, c, steps_to_tissue + steps, steps);
  test::drive(other, c, steps_to_tissue + steps, steps);
  test::drive(host, c, steps_to_tissue + steps, steps);
  for (std::int64_t env : {0, 1})
    check(same_bits(read(whole), env, read(other), env),
          "from a file a device goes on with the same bits", double(env));
  double const v =
      fixed_point_noise(c.domain.cell_size, c.time.step / c.time.substeps, c.time.substeps * steps);
  auto const apart = difference<particle::Position>(read(whole), host.state());
  check(apart < v * steps * c.time.step + 8 * steps * 0x1p-23, "and a host as the device does [m]",
        apart);
}

void require(cudaError_t e, char const* what) {
  if (e != cudaSuccess) check(false, what, e);
}
// A capture fails where anything is allocated or waited for.
void capture_steps(Cuda where) {
  cudaStream_t stream = nullptr;
  require(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "making a stream");
  where.stream = stream;
  auto eager = device_run(3, where), captured = device_run(3, where);
  double const h = config().time.step;
  eager.send(), captured.send();
  for (int s = 0; s < steps; ++s) eager.step_where(h, nullptr);
  cudaGraph_t graph = nullptr;
  cudaGraphExec_t program = nullptr;
  require(cudaStreamBeginCapture(stream, cudaStreamCaptureModeGlobal), "beginning to capture");
  for (int s = 0; s < steps; ++s) captured.step_where(h, nullptr);
  require(cudaStreamEndCapture(stream, &graph), "capturing");
  require(cudaGraphInstantiate(&program, graph, 0), "making a graph of it");
  require(cudaGraphLaunch(program, stream), "starting the graph");
  bool same = true;
  for (std::int64_t env = 0; env < 3; ++env)
    same = same && same_bits(read(eager), env, read(captured), env);
  check(same, "a graph of steps in a stream of the caller's gives their bits");
  auto const usual = device_run(1);
  check(!same_bits(read(usual), 0, read(captured), 0), "and has moved");
  cudaGraphExecDestroy(program);
  cudaGraphDestroy(graph);
}

}  // namespace

int main(int argc, char**) {
  for (Cuda const& where : forms) {
    compare_many(where, argc > 1 ? 200 : 1000);
    mask_some(where);
    capture_steps(where);
  }
  go_on_from_a_file();
  std::printf("bits: %016llx\n", static_cast<unsigned long long>(seen));
  return report.end();
}
