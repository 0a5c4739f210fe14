// How many trials an exchange makes, in states drawn at random.
#include <algorithm>
#include <vector>

#include "catch.hpp"
#include "coupling/random_rig.hpp"
#include "support/sanitized.hpp"

namespace {

using namespace test;

using Rough =
    mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::Friction, mpmpbd::NoDrag, false>;

// A lane that counts how often it waits for its team: eight times a trial, and a few times for what is asked without one.
struct Counting : mpmpbd::Solo {
  int* waits;
  void sync() const { ++*waits; }
};

int waits_of_exchange(Draw& d) {
  auto r = random_rig<double, Rough>(d, {.needle = true, .one_sided = true});
  auto x = r.view();
  mpmpbd::place_thread_points(mpmpbd::Solo{}, x);
  for (auto& p : r.points)
    if (p.contact == Contact::surface) p.axis = mpmpbd::direction(d.arrow<double>());
  mpmpbd::embed_points(mpmpbd::Solo{}, x, r.nodes());
  int waits = 0;
  Counting const team{{}, &waits};
  REQUIRE(mpmpbd::exchange(team, x, r.nodes()) == 0u);
  return waits;
}

}  // namespace

TEST_CASE("an exchange seldom makes many trials", "[coupling][friction]") {
  constexpr int count = repeats(10000), of_a_trial = 8;  // waits
  Draw d(3);
  std::vector<int> waits(count);
  for (int& n : waits) n = waits_of_exchange(d);
  std::sort(waits.begin(), waits.end());
  auto const more_trials = [&](double share) {  // than one a sweep
    auto const at = static_cast<std::size_t>(share * (count - 1));
    return double(waits[at] - waits.front()) / of_a_trial;
  };
  CHECK(more_trials(0.5) <= 4);
  CHECK(more_trials(0.9) <= 6.7);
}
