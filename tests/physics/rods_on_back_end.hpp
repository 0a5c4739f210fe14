// Rods alone that a simulation moves, on the host or on a GPU.
#pragma once

#include <memory>
#include <utility>

#include <mpmpbd/effects/gravity.hpp>
#include <mpmpbd/scene/simulation.hpp>

#include "pbd/rig.hpp"
#include "physics/back_end.hpp"

namespace rods {

template <class Body> struct Heavy : Scene<Body, Gravity> {};

// To be used as a Rig is.
template <class Body, class T = double> class Simulated : public Measured<Simulated<Body, T>> {
  using Run = Simulation<Heavy<Body>, test::BackEnd, T>;
  std::unique_ptr<Run> run_;

 public:
  // The state where it is newest. Reading it after a step brings it from a device, writing it sends it there before the next.
  class Store {
   public:
    template <class D> static constexpr bool has = Run::Store::template has<D>;

    explicit Store(Run& run) : run_(&run) {}
    template <class D> auto const& table() const { return now().template table<D>(); }
    template <class F> auto get(std::int64_t env, std::int64_t slot) const {
      return now().template get<F>(env, slot);
    }
    template <class F> void set(std::int64_t env, std::int64_t slot, value_t<F, T> const& value) {
      run_->state().template set<F>(env, slot, value);
    }

   private:
    auto const& now() const { return std::as_const(*run_).state(); }
    Run* run_;
  };

  explicit Simulated(RodAssembly<Body> const& rod, VisitOrder order = VisitOrder::coloured)
      : run_(std::make_unique<Run>(SimulationOptions{.capacity = rod.capacity(), .substeps = 1})),
        store(*run_) {
    rod.write(run_->state(), 0, order);
  }

  void step(double dt, double g = gravity) {
    run_->template set<Gravity>(0, {{0.0, 0.0, -g}});
    run_->step(dt);
    faults |= run_->status(0);
  }
  template <class C> double residual() {
    auto& state = run_->state();
    return double(
        Body::template residual<C>(access_environment(state, 0, typename Run::Store::Domains{})));
  }

  Store store;
  std::uint32_t faults = 0;
};

}  // namespace rods
