// The exchange inside one thread block: the same text as on the CPU, the same numbers to rounding, and the
// same bits for every number of threads. In float the whole suturing scene is compared (stitch.cpp).
#include <cstdio>
#include <cstring>

#include "coupling/exchange_on_device.cuh"
#include "coupling/random_rig.hpp"
#include "device/report.hpp"

namespace {

using namespace test;
using Q = mpmpbd::QuadraticBSpline;
using Form = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::Drag, true>;
using Plain = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;

// In place of rig.couple().
template <class T, class F> std::uint32_t couple_on_device(Rig<T, F>& rig, int threads) {
  return exchange_on_device(rig, rig.view(), rig.memory.data(), 2, {threads, true});
}

template <class T> bool same_bits(std::vector<T> const& a, std::vector<T> const& b) {
  return std::memcmp(a.data(), b.data(), sizeof(T) * a.size()) == 0;
}

template <class T, class F> void compare(char const* what, Extras const& extra, double tolerance) {
  Draw d(31);
  double worst = 0;
  bool equal = true, clean = true;
  for (int n = 0; n < 20; ++n) {
    auto host = random_rig<T, F>(d, extra);
    for (auto& p : host.points)
      if (p.contact == Contact::off) p.contact = Contact::member;
    auto device = host, narrow = host;
    auto x = host.view();
    mpmpbd::place_thread_points(mpmpbd::Solo{}, x);
    mpmpbd::embed_points(mpmpbd::Solo{}, x, host.nodes());
    clean = clean && mpmpbd::exchange(mpmpbd::Solo{}, x, host.nodes()) == 0u;
    clean = clean && couple_on_device(device, 512) == 0u && couple_on_device(narrow, 33) == 0u;
    equal = equal && same_bits(device.velocity, narrow.velocity) &&
            same_bits(device.bead, narrow.bead) && same_bits(device.impulse, narrow.impulse);
    double scale = 0, apart = 0;
    for (std::size_t i = 0; i < host.velocity.size(); ++i) {
      scale = std::max(scale, double(mpmpbd::norm(host.velocity[i])));
      apart = std::max(apart, double(mpmpbd::norm(host.velocity[i] - device.velocity[i])));
    }
    for (std::size_t k = 0; k < host.bead.size(); ++k)
      apart =
          std::max(apart, double(mpmpbd::norm(host.bead_velocity[k] - device.bead_velocity[k])));
    worst = std::max(worst, apart / scale);
  }
  std::printf("%s: host and device apart by %.2e of the largest speed\n", what, worst);
  check(clean, "no fault");
  check(equal, "512 and 33 threads give the same bits");
  check(worst < tolerance, "host and device agree");
}

}  // namespace

int main() {
  compare<double, Plain>("double, plain", {}, 1e-9);
  compare<double, Form>("double, friction, drag, bending, needle", {.needle = true, .swage = true},
                        1e-7);
  return report.end();
}
