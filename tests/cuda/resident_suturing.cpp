// The resident form of the suturing scene, on an emulated device: it gives what the serial back end gives, and the same
// bits for any order and number of threads.
// seconds: 6
#include <mpmpbd/backend/cuda/simulation.cuh>

#include "catch.hpp"
#include "cuda/fixed_point_noise.hpp"
#include "cuda/suturing.hpp"
#include "support/sanitized.hpp"

using namespace test;

namespace {

void poison(OnDevice& run, std::int64_t env) {
  auto v = run.state().get<bead::Velocity>(env, 7);
  v[1] = std::numeric_limits<float>::quiet_NaN();
  run.state().set<bead::Velocity>(env, 7, v);
}

// The sentence with which a run is refused; empty where it is not.
std::string refusal(SimulationOptions const& options, Cuda where) {
  try {
    OnDevice const run(options, where);
    return {};
  } catch (std::exception const& e) { return e.what(); }
}

}  // namespace

TEST_CASE("a needle and a thread in tissue move on a device as they do on the host",
          "[cuda][resident]") {
  auto const c = config();
  OnHost host(suturing::options(c));
  fill(host, stitch_under_way());
  auto device = device_run(1);
  int const steps = 3;
  drive(host, c, steps_to_tissue, steps);
  drive(device, c, steps_to_tissue, steps);

  auto const &on_device = read(device), &on_host = std::as_const(host).state();
  int const substeps = steps * c.time.substeps;
  double const dt = c.time.step / c.time.substeps, dx = c.domain.cell_size;
  double const v = test::fixed_point_noise(dx, dt, substeps);
  CHECK(difference<particle::Velocity>(on_device, on_host) < v);
  CHECK(difference<particle::Position>(on_device, on_host) < v * steps * c.time.step);
  CHECK(difference<bead::Velocity>(on_device, on_host) < v);
  CHECK(difference<bead::Position>(on_device, on_host) < v * steps * c.time.step);
  double const force = norm(on_host.get<needle::Force>(0, 0));
  REQUIRE(force > 100.0);
  CHECK(norm(on_device.get<needle::Force>(0, 0) - on_host.get<needle::Force>(0, 0)) < 1e-4 * force);
  CHECK(on_device.get<event::Count>(0) == on_host.get<event::Count>(0));
  CHECK(on_device.get<environment::Time>(0) == on_host.get<environment::Time>(0));
  CHECK(device.status(0) == host.status(0));
}

TEST_CASE("bits on a device depend on neither the order nor the number of threads",
          "[cuda][resident]") {
  auto const c = config();
  emulated::seed = 1;
  auto wide = device_run(1);
  drive(wide, c, steps_to_tissue, 2);
  for (unsigned seed : {2u, 3u})
    for (int threads : {128, 224}) {
      if (sanitized && (seed == 2u) == (threads == 128)) continue;
      emulated::seed = seed;
      auto other = device_run(1, {.threads = threads});
      drive(other, c, steps_to_tissue, 2);
      CHECK(same_bits(read(wide), 0, read(other), 0));
    }
}

TEST_CASE("an environment on a device does not feel the others of its batch", "[cuda][batch]") {
  auto const c = config();
  auto alone = device_run(1), pulled = device_run(1), batch = device_run(4);
  auto const pull = [&](OnDevice& run, std::int64_t env, float speed) {
    for (std::int64_t k = 0; k < c.thread.beads; ++k)
      run.state().set<bead::Velocity>(env, k, {{0.0f, speed, 0.0f}});
  };
  pull(pulled, 0, 0.01f), pull(batch, 0, 0.01f), pull(batch, 3, 0.04f);
  poison(batch, 1);
  auto const lost = read(batch).get<particle::Position>(1, 5);
  for (OnDevice* run : {&alone, &pulled, &batch}) drive(*run, c, steps_to_tissue, 3);
  CHECK(same_bits(read(pulled), 0, read(batch), 0));  // they share a block: the grid of one
  CHECK(same_bits(read(alone), 0, read(batch), 2));   // comes when the other's has been gathered
  CHECK_FALSE(same_bits(read(alone), 0, read(batch), 3));
  CHECK(has(batch.status(1), Fault::not_finite));
  CHECK(read(batch).get<environment::Step>(1) == read(batch).get<environment::Step>(2) - 12);
  CHECK(read(batch).get<particle::Position>(1, 5)[0] == lost[0]);
  for (std::int64_t env : {0, 2, 3}) CHECK(batch.status(env) == 0);
}

TEST_CASE("a mask says which environments a device moves, and which it puts back",
          "[cuda][reset]") {
  auto const c = config();
  auto run = device_run(3);
  run.remember();
  auto const start = read(run);
  std::vector<unsigned char> const middle{0, 1, 0};
  double const h = c.time.step;
  run.step(h, middle);
  CHECK(same_bits(start, 0, read(run), 0));
  CHECK_FALSE(same_bits(start, 1, read(run), 1));
  CHECK(same_bits(start, 2, read(run), 2));

  run.step(h);
  auto const moved = read(run);
  run.reset(middle);
  CHECK(same_bits(moved, 0, read(run), 0));
  auto back = read(run);
  CHECK(back.get<environment::Episode>(1) == start.get<environment::Episode>(1) + 1);
  back.set<environment::Episode>(1, start.get<environment::Episode>(1));
  CHECK(same_bits(start, 1, back, 1));
  CHECK_THROWS_AS(run.reset(std::vector<unsigned char>(2)), std::invalid_argument);
}

TEST_CASE("a run goes on from a checkpoint, on the device or back on the host",
          "[cuda][checkpoint]") {
  auto const c = config();
  auto whole = device_run(1), first = device_run(1);
  drive(whole, c, steps_to_tissue, 4);
  drive(first, c, steps_to_tissue, 2);
  OnDevice second(suturing::options(c));
  second.restore(read(first));
  drive(second, c, steps_to_tissue + 2, 2);
  CHECK(same_bits(read(whole), 0, read(second), 0));

  OnHost host(suturing::options(c));
  host.restore(read(whole));
  CHECK(same_bits(read(whole), 0, std::as_const(host).state(), 0));
}

TEST_CASE("a device chooses the substeps that the host chooses", "[cuda][time_step]") {
  auto options = suturing::options(config());
  options.substeps = 0;
  OnHost host(options);
  OnDevice device(options);
  fill(host, stitch_under_way());
  fill(device, stitch_under_way());
  for (double h : {0.004, 0.003, 0.0007, 0.02}) {
    host.step(h);
    device.step(h);
    auto const &a = std::as_const(host).state(), &b = read(device);
    CHECK(a.get<environment::Substeps>(0) == b.get<environment::Substeps>(0));
    CHECK(a.get<environment::Time>(0) == b.get<environment::Time>(0));
    CHECK(a.get<environment::DtLimit>(0) == Approx(b.get<environment::DtLimit>(0)).epsilon(1e-4));
    CHECK(host.status(0) == device.status(0));
  }
}

TEST_CASE("a device holds and counts what leaves the domain, as the host does", "[cuda][status]") {
  auto host_options = suturing::options(config());
  OnHost host(host_options);
  OnDevice device(host_options);
  fill(host, stitch_under_way());
  fill(device, stitch_under_way());
  for (auto* store : {&host.state(), &device.state()}) {
    store->set<particle::Position>(0, 11, {{-3.0f, 0.7f, 9.0f}});
    store->set<particle::Velocity>(0, 12, {{0.0f, 0.0f, 60.0f}});  // beyond half a cell
  }
  host.step(0.004);
  device.step(0.004);
  auto const &a = std::as_const(host).state(), &b = read(device);
  CHECK(has(device.status(0), Fault::escape));
  CHECK(has(device.status(0), Fault::time_step));
  CHECK(device.status(0) == host.status(0));
  auto const counted = a.get<environment::FaultCount>(0),
             on_device = b.get<environment::FaultCount>(0);
  for (int f = 0; f < fault_count; ++f) CHECK(counted[f] == on_device[f]);
}

TEST_CASE("a step is one launch and takes no memory", "[cuda][resources]") {
  auto run = device_run(2);
  run.step(0.004);
  int const launches = emulated::launches, allocations = emulated::allocations;
  for (int s = 0; s < 3; ++s) run.step_where(0.004, nullptr);
  CHECK(emulated::launches == launches + 3);
  CHECK(emulated::allocations == allocations);
}

TEST_CASE("fields on a device are seen where they lie", "[cuda][arrays]") {
  auto const c = config();
  auto run = device_run(2);
  auto const x = run.array<particle::Position>();
  CHECK(x.shape[0] == 2);
  CHECK(x.shape[1] == c.tissue.point_count());
  CHECK(x.shape[2] == 3);
  CHECK(x.element == element_type<float>);
  CHECK(run.array<environment::Status>().element == element_type<std::int64_t>);
  CHECK(x.place.memory == MemorySpace::cuda);
  CHECK(array_named(run, "particle.x").data == x.data);
  run.step(0.004);
  auto const expected = read(run).get<particle::Position>(1, 42);
  for (int a = 0; a < 3; ++a)  // an emulated device shares the host's memory
    CHECK(static_cast<float const*>(x.data)[x.strides[0] + 42 * x.strides[1] + a * x.strides[2]] ==
          expected[a]);
}

TEST_CASE("what a device cannot do is refused before anything is taken", "[cuda][refusal]") {
  auto const good = suturing::options(config());
  int const allocations = emulated::allocations;
  auto large = good;
  large.nodes[0] = 60;
  CHECK(refusal(large, {.execution = Cuda::Execution::resident}).find("shared memory") !=
        std::string::npos);
  CHECK(refusal(good, {.device = 1}).find("device 1") != std::string::npos);
  CHECK(refusal(good, {.threads = 100}).find("threads = 100") != std::string::npos);
  auto strict = good;
  strict.strict = true;
  CHECK(refusal(strict, {}).find("strict = true") != std::string::npos);
  emulated::free_bytes = 1000;
  CHECK(refusal(good, {}).find("MiB needed") != std::string::npos);
  emulated::free_bytes = std::size_t{1} << 34;
  CHECK(emulated::allocations == allocations);
}

TEST_CASE("a mask of the host's is waited for, and one of the device's is not", "[cuda][masks]") {
  auto run = device_run(2);
  run.step(0.004);
  std::vector<unsigned char> const mask{0, 1};  // an emulated device shares the host's memory
  int const waits = emulated::waits;
  run.step_where(0.004, mask.data());
  run.reset_where(mask.data());
  CHECK(emulated::waits == waits);
  run.step(0.004, mask);
  CHECK(emulated::waits == waits + 1);
  run.reset(mask);
  CHECK(emulated::waits == waits + 2);
}

TEST_CASE("a step whose work memory is refused can be taken once there is some",
          "[cuda][refusal]") {
  auto run = device_run(1), other = device_run(1);
  emulated::free_bytes = 0;  // what a thread in tissue needs is asked for when it is sent
  CHECK_THROWS_AS(run.step(0.004), std::runtime_error);
  emulated::free_bytes = std::size_t{1} << 34;
  run.step(0.004);
  other.step(0.004);
  CHECK(same_bits(read(run), 0, read(other), 0));
}

// A reset brings back beads that the host does not know of.
TEST_CASE("the remembered state has work memory after some was refused", "[cuda][refusal][reset]") {
  auto o = suturing::options(config());
  for (Capacity& c : o.capacity)
    if (c.domain == Beads::name.view() || c.domain == ContactPoints::name.view()) c.slots += 1000;
  Simulation<Suturing, Cuda, float> run(o);
  suturing::set_up(run, 0, config());
  run.remember();
  std::size_t const remembered = emulated::taken_bytes();
  auto const beads = read(run).table<Beads>().live(0);
  emulated::free_bytes = 0;
  run.state().table<Beads>().set_live(0, beads + 1000);
  CHECK_THROWS_AS(run.step(0.004), std::runtime_error);
  emulated::free_bytes = std::size_t{1} << 34;
  CHECK(emulated::taken_bytes() < remembered);
  run.state().table<Beads>().set_live(0, 1);
  run.reset();
  CHECK(emulated::taken_bytes() == remembered);
  CHECK(read(run).table<Beads>().live(0) == beads);
}
