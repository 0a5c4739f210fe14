// Laws of a batch: environments do not know of each other, and back ends give the same bits.
//
// Every law compares all stored fields of all domains bit for bit; the error is the number of
// environments that differ, and the limit is 0.
#pragma once

#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/scene/simulation.hpp>
#include <mpmpbd/testing/law.hpp>

namespace mpmpbd {

namespace testing {

// Whether two environments hold the same bits. `apart_from_episode`: the count of resets may differ.
template <class Store>
bool same_bits(Store const& a, std::int64_t i, Store const& b, std::int64_t j,
               bool apart_from_episode = false) {
  bool same = true;
  for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
    auto const& s = a.template table<D>();
    auto const& t = b.template table<D>();
    same = same && s.live(i) == t.live(j) && s.capacity() == t.capacity();
    if (!same) return;
    for_each_field(on_t<typename Store::List, D>{}, [&]<class F>(F) {
      if (apart_from_episode && std::is_same_v<F, environment::Episode>) return;
      auto const& p = s.template planes<F>();
      auto const& q = t.template planes<F>();
      auto const capacity = static_cast<std::size_t>(s.capacity());
      for (std::size_t c = 0; c < static_cast<std::size_t>(F::components); ++c) {
        auto const* x = p.data() + (c * static_cast<std::size_t>(s.environments()) +
                                    static_cast<std::size_t>(i)) *
                                       capacity;
        auto const* y = q.data() + (c * static_cast<std::size_t>(t.environments()) +
                                    static_cast<std::size_t>(j)) *
                                       capacity;
        same = same && (capacity == 0 || std::memcmp(x, y, capacity * sizeof(*x)) == 0);
      }
    });
  });
  return same;
}

// A scene under test: how a run is made, how environment `env` is filled with variant `which`, how
// long a step is and how many are taken.
template <class Fill> struct BatchCase {
  SimulationOptions options;  // the number of environments is set by the laws
  Fill fill;                  // fill(simulation, env, which)
  double step;                // [s]
  int steps;
};

template <class Scene, class T, class Fill> class BatchProbe {
 public:
  static constexpr int variants = 4;
  template <class Backend> using Run = Simulation<Scene, Backend, T>;

  explicit BatchProbe(BatchCase<Fill> const& c) : case_(c), reference_(run({0, 1, 2, 3})) {}

  template <class Backend = Serial>
  Run<Backend> make(std::vector<int> const& which, Backend backend = {}) const {
    auto options = case_.options;
    options.environments = static_cast<std::int64_t>(which.size());
    Run<Backend> r(options, backend);
    for (std::size_t e = 0; e < which.size(); ++e)
      case_.fill(r, static_cast<std::int64_t>(e), which[e]);
    r.remember();
    return r;
  }
  template <class R> void advance(R& r) const {
    for (int s = 0; s < case_.steps; ++s) r.step(case_.step);
  }
  template <class Backend = Serial>
  Run<Backend> run(std::vector<int> const& which, Backend backend = {}) const {
    auto r = make(which, backend);
    advance(r);
    return r;
  }

  // How many environments of `r` differ from the reference run of the variant that they hold.
  template <class R>
  double different(R const& r, std::vector<int> const& which,
                   bool apart_from_episode = false) const {
    int count = 0;
    for (std::size_t e = 0; e < which.size(); ++e)
      if (which[e] >= 0)
        count += !same_bits(r.state(), static_cast<std::int64_t>(e), reference_.state(), which[e],
                            apart_from_episode);
    return count;
  }

  Run<Serial> const& reference() const { return reference_; }

  double alone() const {
    double count = 0;
    for (int v = 0; v < variants; ++v) count += different(run({v}), {v});
    return count;
  }
  double permuted() const { return different(run({2, 0, 3, 1}), {2, 0, 3, 1}); }
  double threads() const {
    double count = 0;
    for (int n = 1; n <= 4; ++n) {
      count += different(run({0, 1, 2, 3}, Threads{n}), {0, 1, 2, 3});
      if (n > 1) count += different(run({1}, Threads{n}), {1});  // threads inside an environment
    }
    return count;
  }
  // A step, a masked reset of environment 1, a run: 1 is where a run from the start ends, the others are a step
  // further than it.
  double reset_leaves_others() const {
    auto r = make({0, 1, 2, 3});
    r.step(case_.step);
    auto const before = r.state();
    std::vector<unsigned char> const mask{0, 1, 0, 0};
    r.reset(mask);
    int count = 0;
    for (int e : {0, 2, 3}) count += !same_bits(r.state(), e, before, e);
    advance(r);
    auto further = run({0, 1, 2, 3});
    further.step(case_.step);
    for (int e : {0, 2, 3}) count += !same_bits(r.state(), e, further.state(), e);
    return count + different(r, {-1, 1, -1, -1}, true);
  }
  double reset_is_exact() const {
    auto r = run({0, 1, 2, 3});
    r.reset();
    advance(r);
    return different(r, {0, 1, 2, 3}, true);
  }
  // Cloned before the first step, and again in the middle of whatever a run has led to.
  double clone_is_exact() const {
    auto r = make({0, 1, 2, 3});
    r.clone(0, 2);
    advance(r);
    double count = different(r, {0, 1, 0, 3});
    r = run({0, 1, 2, 3});
    r.clone(1, 2);
    count += !same_bits(r.state(), 2, reference_.state(), 1);
    advance(r);
    return count + !same_bits(r.state(), 2, r.state(), 1);
  }

  // Environment 1 is spoilt by `spoil` before the run: its bit is set, the others keep their bits.
  template <class Spoil> double contained(Fault bit, Spoil&& spoil) const {
    auto r = make({0, 1, 2, 3});
    spoil(r);
    advance(r);
    return different(r, {0, -1, 2, 3}) + !has(r.status(1), bit);
  }
  double frozen() const {
    auto r = make({0, 1, 2, 3});
    spoil_position(r);
    r.step(case_.step);
    auto const after = r.state();
    r.step(case_.step);
    return !same_bits(r.state(), 1, after, 1);
  }
  template <class R> static void spoil_position(R& r) {
    auto x = r.state().template get<particle::Position>(1, 0);
    x[1] = std::numeric_limits<T>::quiet_NaN();
    r.state().template set<particle::Position>(1, 0, x);
  }

 private:
  BatchCase<Fill> case_;
  Run<Serial> reference_;
};

}  // namespace testing

// The laws of a batch of four different environments of a scene with a tissue body.
template <class Scene, class T, class Fill> Laws batch_laws(testing::BatchCase<Fill> const& c) {
  testing::BatchProbe<Scene, T, Fill> const probe(c);
  Laws laws;
  auto const add = [&](char const* name, double count) { laws.push_back({name, count, 0.0}); };
  add("together = alone", probe.alone());
  add("permuted environments give permuted results", probe.permuted());
  add("serial = 1, 2, 3, 4 threads", probe.threads());
  add("reset leaves other environments", probe.reset_leaves_others());
  add("a run after reset repeats", probe.reset_is_exact());
  add("clone", probe.clone_is_exact());
  if constexpr (Scene::has_body) {
    add("a NaN position is flagged and contained", probe.contained(Fault::not_finite, [](auto& r) {
      testing::BatchProbe<Scene, T, Fill>::spoil_position(r);
    }));
    add("an environment with a NaN is frozen", probe.frozen());
  }
  return laws;
}

}  // namespace mpmpbd
