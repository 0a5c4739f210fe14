// The exchange of a rig, carried out by one thread block.
#pragma once

#include <cstdint>
#include <span>

#include <mpmpbd/backend/cuda/memory.cuh>
#include <mpmpbd/backend/cuda/team.cuh>

#include "coupling/rig.hpp"

namespace test {

// The numbers of a list in the memory of the device.
template <class U> class Mirror {
 public:
  explicit Mirror(std::span<U> here) : here_(here), there_(here.size_bytes()) {
    mpmpbd::cuda::copy({}, there_.as(), here.data(), here.size_bytes(), cudaMemcpyHostToDevice);
  }
  U* data() const { return there_.template as<U>(); }
  // Waits for the device.
  void fetch() const {
    mpmpbd::cuda::copy({}, here_.data(), there_.as(), here_.size_bytes(), cudaMemcpyDeviceToHost);
    mpmpbd::cuda::require(cudaStreamSynchronize({}), "an exchange");
  }

 private:
  std::span<U> here_;
  mpmpbd::cuda::Memory there_;
};

// A rig on the device, where a view of it lies in `memory` on the host: what an exchange changes is fetched afterwards.
template <class T, class RigForm, class Form> class RigOnDevice {
 public:
  RigOnDevice(Rig<T, RigForm>& r, mpmpbd::ExchangeView<T, Form> const& x, char* memory)
      : mass_(r.mass),
        inverse_mass_(r.inverse_mass),
        velocity_(r.velocity),
        bead_(r.bead),
        bead_velocity_(r.bead_velocity),
        bead_mass_(r.bead_mass),
        rest_length_(r.rest_length),
        rest_angle_(r.rest_angle),
        impulse_(r.impulse),
        known_(r.known),
        needle_(std::span(&r.needle, 1)),
        points_(r.points),
        memory_(std::span(memory, mpmpbd::exchange_bytes<T, Form>(r.capacity()))),
        view_(x) {
    view_.thread.position = bead_.data();
    view_.thread.velocity = bead_velocity_.data();
    view_.thread.mass = bead_mass_.data();
    view_.thread.known = reinterpret_cast<bool const*>(known_.data());
    view_.thread.rest_length = rest_length_.data();
    view_.thread.rest_angle = rest_angle_.data();
    view_.thread.impulse = impulse_.data();
    view_.needle = needle_.data();
    view_.points = points_.data();
    mpmpbd::use_workspace(view_, r.capacity(), memory_.data());
  }
  mpmpbd::ExchangeView<T, Form> const& view() const { return view_; }
  GridNodes<T> nodes() const { return {mass_.data(), inverse_mass_.data(), velocity_.data()}; }
  void fetch() const {
    for (auto const* moved : {&velocity_, &bead_, &bead_velocity_}) moved->fetch();
    impulse_.fetch();
    needle_.fetch();
    points_.fetch();
    memory_.fetch();
  }

 private:
  Mirror<T> mass_;
  Mirror<Vec3<T>> inverse_mass_, velocity_, bead_, bead_velocity_;
  Mirror<T> bead_mass_, rest_length_, rest_angle_, impulse_;
  Mirror<char> known_;
  Mirror<mpmpbd::RigidBody<T>> needle_;
  Mirror<mpmpbd::ContactPoint<T>> points_;
  Mirror<char> memory_;
  mpmpbd::ExchangeView<T, Form> view_;
};

// `places`: the thread's points are placed and embedded there first.
template <class T, class Form>
__global__ void __launch_bounds__(512)
    exchange_by_block(mpmpbd::ExchangeView<T, Form> x, GridNodes<T> nodes, int sweeps, bool places,
                      std::uint32_t* faults) {
  mpmpbd::BlockTeam const team;
  if (places) {
    mpmpbd::place_thread_points(team, x);
    mpmpbd::embed_points(team, x, nodes);
  }
  std::uint32_t const found = mpmpbd::exchange(team, x, nodes, sweeps);
  if (threadIdx.x == 0) *faults = found;
}

struct OfBlock {
  int threads = 256;
  bool places = false;
};
template <class T, class RigForm, class Form>
std::uint32_t exchange_on_device(Rig<T, RigForm>& rig, mpmpbd::ExchangeView<T, Form> const& x,
                                 char* memory, int sweeps = 2, OfBlock how = {}) {
  RigOnDevice const there(rig, x, memory);
  std::uint32_t faults = 99;  // what no exchange returns
  Mirror const found(std::span(&faults, 1));
  mpmpbd::cuda::start({}, "an exchange", exchange_by_block<T, Form>, 1, how.threads, 0,
                      there.view(), there.nodes(), sweeps, how.places, found.data());
  there.fetch();
  found.fetch();
  return faults;
}

}  // namespace test
