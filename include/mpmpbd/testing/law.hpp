// What a law suite reports: each law with its worst error and the limit it has to keep.
//
// The suites are installed and use no test framework, so that users check their own policies with them.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace mpmpbd::testing {

// One law: `worst` is the largest error met, in the unit that `name` states (relative by default).
struct Law {
  std::string name;
  double worst = 0.0;
  double limit = 0.0;
  bool pass() const { return worst <= limit; }  // false for NaN
};

// The largest of several errors; a NaN is the largest of all and stays.
class Worst {
 public:
  void include(double error) {
    if (worst_ == worst_ && !(error <= worst_)) worst_ = error;
  }
  double value() const { return worst_; }

 private:
  double worst_ = 0.0;
};

// The laws of one policy or composition.
class Laws {
 public:
  explicit Laws(std::string subject) : subject_(std::move(subject)) {}

  void add(std::string name, double worst, double limit) {
    laws_.push_back({std::move(name), worst, limit});
  }
  void add(std::string name, Worst const& worst, double limit) {
    add(std::move(name), worst.value(), limit);
  }
  // A law that holds or not.
  void add(std::string name, bool holds) { add(std::move(name), holds ? 0.0 : 1.0, 0.0); }

  std::string const& subject() const { return subject_; }
  std::vector<Law> const& all() const { return laws_; }
  // The law of a name, or nullptr.
  Law const* find(std::string const& name) const {
    for (auto const& law : laws_)
      if (law.name == name) return &law;
    return nullptr;
  }
  bool pass() const {
    for (auto const& law : laws_)
      if (!law.pass()) return false;
    return !laws_.empty();
  }
  // One line per law: verdict, worst error, limit, name.
  std::string text() const {
    std::string out = subject_ + "\n";
    for (auto const& law : laws_) {
      char numbers[64];
      std::snprintf(numbers, sizeof numbers, "  %s  %9.2e  <= %9.2e  ",
                    law.pass() ? "pass" : "FAIL", law.worst, law.limit);
      out += numbers + law.name + "\n";
    }
    return out;
  }

 private:
  std::string subject_;
  std::vector<Law> laws_;
};

// Random numbers that are the same on every machine and compiler: a counter through SplitMix64.
class Random {
 public:
  explicit Random(unsigned long long seed) : counter_(seed * 0x9E3779B97F4A7C15ull) {}
  // Uniform in [low, high).
  double operator()(double low, double high) { return low + (high - low) * unit(); }
  double unit() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  unsigned long long bits() {
    unsigned long long z = (counter_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }

 private:
  unsigned long long counter_;
};

}  // namespace mpmpbd::testing
