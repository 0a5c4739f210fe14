// The stitch of preset coarse as the tests of units and of places run it: the scripted hand leads a needle with a
// thread through tissue.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/catalog/suturing_hand.hpp>
#include <mpmpbd/testing/samples.hpp>

#include "support/presets.hpp"

namespace test {

template <class T> using StitchRun = mpmpbd::Simulation<mpmpbd::Suturing, mpmpbd::Serial, T>;

// Moves every particle and bead by up to `size` [m], as rounding might have done.
template <class T> void shake(StitchRun<T>& run, double size, std::uint64_t seed = 3) {
  mpmpbd::testing::Samples random(seed);
  auto move = [&]<class F>(F) {
    for (std::int64_t i = 0; i < run.state().template table<typename F::Domain>().live(0); ++i)
      run.state().template set<F>(
          0, i,
          run.state().template get<F>(0, i) + mpmpbd::cast<T>(size * random.matrix<3>(-1.0, 1.0)));
  };
  move(mpmpbd::particle::Position{});
  move(mpmpbd::bead::Position{});
}

// What two runs of a stitch differ by: the largest difference of a field over its largest magnitude.
struct StitchDifference {
  double tissue, strain, thread, force, tension;

  template <class T>
  static StitchDifference of(StitchRun<T> const& a, StitchRun<T> const& b,
                             mpmpbd::Vec3<double> const& shift = {}) {
    return {field<mpmpbd::particle::Position>(a, b, shift),
            field<mpmpbd::particle::Deformation>(a, b), field<mpmpbd::bead::Position>(a, b, shift),
            field<mpmpbd::needle::Force>(a, b), field<mpmpbd::bead::Tension>(a, b)};
  }
  void include(StitchDifference const& other) {
    for (auto member :
         {&StitchDifference::tissue, &StitchDifference::strain, &StitchDifference::thread,
          &StitchDifference::force, &StitchDifference::tension})
      this->*member = std::max(this->*member, other.*member);
  }
  double most() const { return std::max({tissue, strain, thread, force, tension}); }

 private:
  template <class F, class T>
  static double field(StitchRun<T> const& a, StitchRun<T> const& b,
                      mpmpbd::Vec3<double> const& shift = {}) {
    double most = 0.0, largest = 0.0;
    for (std::int64_t i = 0; i < a.state().template table<typename F::Domain>().live(0); ++i) {
      auto const x = a.state().template get<F>(0, i), y = b.state().template get<F>(0, i);
      for (int c = 0; c < F::components; ++c) {
        double const moved = component(y, c) - (c < 3 ? shift[c] : 0.0);
        double const apart = std::abs(component(x, c) - moved);
        if (!mpmpbd::is_finite(apart)) return std::numeric_limits<double>::infinity();
        most = std::max(most, apart);
        largest = std::max(largest, std::abs(component(x, c)));
      }
    }
    return largest > 0.0 ? most / largest : most;
  }
  template <class V> static double component(V const& v, int c) {
    if constexpr (std::is_arithmetic_v<V>)
      return static_cast<double>(v);
    else
      return static_cast<double>(v[c]);
  }
};

}  // namespace test
