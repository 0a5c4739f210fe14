// A stitch under way on a GPU, driven by plain C++: needle and thread in tissue, with surface, puncture and channel, go on
// as on the host, and with the same bits in either form of execution, in company and for any number of threads.
//
// An argument, whatever it is, leaves out all but one run: for compute-sanitizer.
#include <cmath>
#include <cstdio>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog.hpp>

#include "cuda/fixed_point_noise.hpp"
#include "cuda/suturing.hpp"
#include "device/report.hpp"

namespace {

using namespace mpmpbd;
using test::check;
using test::OnDevice;
using test::read;
using OnHost = Simulation<Suturing, Threads, float>;

// The needle's tip is in tissue; ten beads have followed the needle.
constexpr int tip_in_tissue = test::steps_to_tissue, thread_in_tissue = 2300, steps = 2;
constexpr Cuda resident{.execution = Cuda::Execution::resident};

OnDevice goes_on(OnHost const& from, int first, std::int64_t environments, Cuda where = resident) {
  OnDevice run(suturing::options(test::config(), environments), where);
  for (std::int64_t env = 0; env < environments; ++env)
    run.state().copy_environment(env, from.state(), 0);
  test::drive(run, test::config(), first, steps);
  return run;
}
// As for the emulated device, and eight roundings of a position of up to 2 m per step for other arithmetic.
void compare_with_host(OnDevice const& device, OnHost const& host) {
  auto const c = test::config();
  double const v = test::fixed_point_noise(c.domain.cell_size, c.time.step / c.time.substeps,
                                           c.time.substeps * steps);  // [m/s]
  double const x = v * steps * c.time.step + 8 * steps * 0x1p-23;
  auto const &d = read(device), &h = host.state();
  auto const tissue = test::difference<particle::Position>(d, h),
             thread = test::difference<bead::Position>(d, h);
  check(tissue < x, "tissue is where it is on the host [m]", tissue);
  check(thread < x, "and so is the thread [m]", thread);
  double largest = 0.0;
  auto const& points = h.table<ContactPoints>();
  for (std::int64_t q = 0; q < points.live(0); ++q)
    largest = std::fmax(largest, norm(points.get<contact::Impulse>(0, q)));
  double const off = test::difference<contact::Impulse>(d, h) / largest;
  check(off < 0.01, "impulses are the host's, of the largest", off);
  using Member = channel::Member<ContactPoints>;
  check(test::difference<Member>(d, h) == 0.0, "the same points are in the channel");
  check(device.status(0) == host.status(0), "the status is the host's", device.status(0));
}

void compare_companies(OnDevice const& device, OnHost const& from, int first) {
  auto const same = [&](OnDevice const& other, std::int64_t env) {
    return test::same_bits(read(device), 0, read(other), env);
  };
  check(same(goes_on(from, first, 3), 2), "in company it has the same bits");
  check(same(goes_on(from, first, 1, {.threads = 160, .execution = resident.execution}), 0),
        "160 threads give the same bits");
  check(same(goes_on(from, first, 1, {.execution = Cuda::Execution::tiled}), 0),
        "tiled execution gives the same bits");
}

}  // namespace

int main(int argc, char**) {
  bool const brief = argc > 1;
  OnHost host(suturing::options(test::config()));
  suturing::set_up(host, 0, test::config());
  int done = 0;
  for (int first : {tip_in_tissue, thread_in_tissue}) {
    test::drive(host, test::config(), done, first - done);
    done = first;
    auto const device = goes_on(host, first, 1);
    if (brief) {
      check(!has(device.status(0), Fault::not_finite), "it goes on", device.status(0));
      continue;
    }
    auto const from = host;
    test::drive(host, test::config(), first, steps);
    done += steps;
    compare_with_host(device, host);
    compare_companies(device, from, first);
  }
  return test::report.end();
}
