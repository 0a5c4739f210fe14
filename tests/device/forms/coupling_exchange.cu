// The exchange inside one thread block: the same text as on the CPU, the same numbers to rounding, and the
// same bits for every number of threads. In float the whole suturing scene is compared (stitch.cpp).
#include <cstdio>
#include <cstring>

#include <mpmpbd/backend/cuda/team.cuh>

#include "coupling/random_rig.hpp"
#include "device/report.hpp"

namespace {

using namespace test;
using Q = mpmpbd::QuadraticBSpline;
using Form = mpmpbd::EmbeddedForm<Q, mpmpbd::Friction, mpmpbd::Drag, true>;
using Plain = mpmpbd::EmbeddedForm<Q, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;

template <class T, class F>
__global__ void __launch_bounds__(512)
    exchange_kernel(mpmpbd::ExchangeView<T, F> x, GridNodes<T> nodes, std::uint32_t* faults) {
  mpmpbd::BlockTeam const team;
  mpmpbd::place_thread_points(team, x);
  mpmpbd::embed_points(team, x, nodes);
  std::uint32_t const found = mpmpbd::exchange(team, x, nodes);
  if (threadIdx.x == 0) *faults = found;
}

template <class U> U* upload(std::vector<U> const& from) {
  U* to = nullptr;
  cudaMalloc(&to, sizeof(U) * (from.size() + 1));
  cudaMemcpy(to, from.data(), sizeof(U) * from.size(), cudaMemcpyHostToDevice);
  return to;
}
template <class U> void download(std::vector<U>& to, U* from) {
  cudaMemcpy(to.data(), from, sizeof(U) * to.size(), cudaMemcpyDeviceToHost);
  cudaFree(from);
}

// One exchange on the device, in place of rig.couple().
template <class T, class F> std::uint32_t couple_on_device(Rig<T, F>& r, int threads) {
  auto x = r.view();
  auto* mass = upload(r.mass);
  auto* inverse = upload(r.inverse_mass);
  auto* velocity = upload(r.velocity);
  auto* bead = upload(r.bead);
  auto* bead_velocity = upload(r.bead_velocity);
  auto* bead_mass = upload(r.bead_mass);
  auto* known = upload(r.known);
  auto* rest_length = upload(r.rest_length);
  auto* rest_angle = upload(r.rest_angle);
  auto* impulse = upload(r.impulse);
  auto* points = upload(r.points);
  auto* memory = upload(r.memory);
  std::vector<mpmpbd::RigidBody<T>> needle{r.needle};
  auto* body = upload(needle);
  std::vector<std::uint32_t> faults{99};
  auto* found = upload(faults);

  x.thread.position = bead;
  x.thread.velocity = bead_velocity;
  x.thread.mass = bead_mass;
  x.thread.known = reinterpret_cast<bool const*>(known);
  x.thread.rest_length = rest_length;
  x.thread.rest_angle = rest_angle;
  x.thread.impulse = impulse;
  x.needle = body;
  x.points = points;
  mpmpbd::use_workspace(x, r.capacity(), memory);
  exchange_kernel<<<1, threads>>>(x, GridNodes<T>{mass, inverse, velocity}, found);
  cudaError_t const error = cudaDeviceSynchronize();
  if (error != cudaSuccess) std::printf("%s\n", cudaGetErrorString(error));

  download(r.velocity, velocity);
  download(r.bead, bead);
  download(r.bead_velocity, bead_velocity);
  download(r.impulse, impulse);
  download(r.points, points);
  download(needle, body);
  download(faults, found);
  r.needle = needle[0];
  for (auto* p :
       {static_cast<void*>(mass), static_cast<void*>(inverse), static_cast<void*>(bead_mass),
        static_cast<void*>(known), static_cast<void*>(rest_length), static_cast<void*>(rest_angle),
        static_cast<void*>(memory)})
    cudaFree(p);
  return faults[0];
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
