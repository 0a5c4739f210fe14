// Lanes of a group as threads of the host, so that the text of a group is tested with several lanes without a device.
#pragma once

#include <algorithm>
#include <barrier>
#include <cstring>
#include <thread>
#include <vector>

#include <mpmpbd/coupling/team.hpp>

namespace test {

// What the lanes of one group share.
struct Meeting {
  explicit Meeting(int lanes)
      : count(lanes), all(lanes), brought(static_cast<std::size_t>(lanes)) {}
  int count;
  std::barrier<> all;
  std::vector<std::int64_t> brought;
};

struct Lane {
  Meeting* meeting;
  int number;

  template <class F> void each(int n, F const& f) const {
    for (int i = number; i < n; i += meeting->count) f(i);
  }
  template <class F> void one(F const& f) const {
    if (number == 0) f();
  }
  void sync() const { meeting->all.arrive_and_wait(); }
  template <class T> T min(T a) const {
    return over_all(a, [](T x, T y) { return y < x || !(x == x) ? y : x; });
  }
  int sum(int a) const {
    return over_all(a, [](int x, int y) { return x + y; });
  }
  int sum_before(int a) const {
    int const up_to_mine = over(number + 1, a, [](int x, int y) { return x + y; });
    return up_to_mine - a;
  }
  mpmpbd::Piece part(int n) const {
    int const length = (n + meeting->count - 1) / meeting->count, first = number * length;
    return {std::min(first, n), std::min(first + length, n)};
  }

 private:
  template <class T, class F> T over_all(T mine, F const& join) const {
    return over(meeting->count, mine, join);
  }
  // Of the first `lanes` lanes.
  template <class T, class F> T over(int lanes, T mine, F const& join) const {
    auto* const brought = meeting->brought.data();
    std::memcpy(brought + number, &mine, sizeof mine);
    sync();
    T result, next;
    std::memcpy(&result, brought, sizeof result);
    for (int i = 1; i < lanes; ++i) {
      std::memcpy(&next, brought + i, sizeof next);
      result = join(result, next);
    }
    sync();
    return result;
  }
};
static_assert(mpmpbd::Group<Lane>);

// Calls f(lane) on all lanes of a group at the same time.
template <class F> void run_on_lanes(int count, F const& f) {
  Meeting meeting(count);
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i) threads.emplace_back([&, i] { f(Lane{&meeting, i}); });
  for (auto& t : threads) t.join();
}

}  // namespace test
