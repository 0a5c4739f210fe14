// Random numbers of an episode: a function of seed, environment, episode and count, so nothing is
// hidden.
#pragma once

#include <cstdint>

#include <Random123/philox.h>

#include <mpmpbd/core/math.hpp>

namespace mpmpbd::rl {

// The stream of one environment's episode. It does not depend on other environments, on earlier
// episodes or on threads. Philox 4x32-10 (Salmon et al. 2011).
class Random {
 public:
  MPMPBD_HD Random(std::int64_t seed, std::int64_t environment, std::int64_t episode)
      : key_{{low(seed), high(seed)}},
        counter_{{0u, low(environment), low(episode), high(episode)}} {}

  // Evenly in [0, 1), a multiple of 2^-24: the same number in float and double.
  MPMPBD_HD double uniform() {
    auto const block = generator_(counter_, key_);
    ++counter_.v[0];
    return static_cast<double>(block.v[0] >> 8) * 0x1p-24;
  }
  MPMPBD_HD double between(double from, double to) { return from + (to - from) * uniform(); }
  // Evenly in the logarithm, for factors: as often twice as half.
  MPMPBD_HD double factor(double from, double to) { return from * ::pow(to / from, uniform()); }

 private:
  static MPMPBD_HD constexpr std::uint32_t low(std::int64_t n) {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(n) & 0xffffffffu);
  }
  static MPMPBD_HD constexpr std::uint32_t high(std::int64_t n) {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(n) >> 32);
  }

  r123::Philox4x32 generator_{};
  r123::Philox4x32::key_type key_;
  r123::Philox4x32::ctr_type counter_;
};

}  // namespace mpmpbd::rl
