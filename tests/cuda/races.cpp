// The emulated device under the thread sanitizer (scripts/test.sh --sanitize tsan): it sees the races that a GPU would
// have, and no others. Without the sanitizer these programs run, and nothing is looked for.
#include "catch.hpp"

#include <vector>

#include <cuda_pipeline_primitives.h>

namespace {
int reported = 0;
}  // namespace

// Called by the sanitizer, which is to tell each race though it knows one like it; those that are asked for here are no failure
// of the program.
extern "C" {
char const* __tsan_default_options();
void __tsan_on_report(void*);
int __tsan_on_finalize(int);

char const* __tsan_default_options() {
  return "suppress_equal_stacks=0:suppress_equal_addresses=0";
}
// In the middle of a report nothing must be looked for.
__attribute__((no_sanitize("thread"))) void __tsan_on_report(void*) { ++reported; }
int __tsan_on_finalize(int) { return 0; }
}

namespace {

// Whether races are to be seen.
constexpr bool seen = emulated::races::sought;

struct Thread {
  std::vector<int>&a, &b, &c;
  unsigned own, other;  // places in them
};
// Whether races are seen in a block whose threads call f. The sanitizer tells one race of an address and then no other: all
// memory is new.
template <class F> bool races_in(F const& f) {
  constexpr unsigned threads = 64;
  std::vector<int> a(threads), b(threads), c(threads);
  int const before = reported;
  blockDim = dim3(threads);
  emulated::Block(threads, [&] {
    f(Thread{a, b, c, threadIdx.x, threads - 1 - threadIdx.x});
  }).run();
  return reported > before;
}

void copy(int& to, int const& from) { __pipeline_memcpy_async(&to, &from, sizeof to); }

}  // namespace

TEST_CASE("a race between two barriers is seen", "[cuda][races]") {
  CHECK(races_in([](Thread const& t) {
          t.a[t.own] = 1;
          t.b[t.own] = t.a[t.other];
        }) == seen);
  CHECK(races_in([](Thread const& t) {  // read, then overwritten
          t.a[t.own] = 1;
          __syncthreads();
          t.b[t.own] = t.a[t.other];
          t.a[t.own] = 2;
        }) == seen);
}

TEST_CASE("barriers, warps that meet and atomic operations leave no race", "[cuda][races]") {
  CHECK_FALSE(races_in([](Thread const& t) {
    for (int turn = 0; turn < 5; ++turn) {
      t.a[t.own] = turn;
      __syncthreads();
      t.b[t.own] = t.a[t.other];
      __syncthreads();
    }
  }));
  CHECK_FALSE(races_in([](Thread const& t) {
    t.a[t.own] = 3;
    __syncwarp(~0u);
    t.b[t.own] = t.a[t.own ^ 1u];
  }));
  CHECK_FALSE(races_in([](Thread const& t) { atomicAdd(&t.a[0], 2); }));
}

TEST_CASE("a copy that goes on meanwhile may be made at any time until it is waited for",
          "[cuda][races]") {
  CHECK_FALSE(races_in([](Thread const& t) {
    for (int turn = 0; turn < 3; ++turn) {
      copy(t.a[t.own], t.b[t.own]);
      __syncthreads();
      __pipeline_wait_prior(0);
      __syncthreads();
      t.c[t.own] = t.a[t.other];
      __syncthreads();
    }
  }));
  CHECK(races_in([](Thread const& t) {  // read before it is waited for
          copy(t.a[t.own], t.b[t.own]);
          __syncthreads();
          t.c[t.own] = t.a[t.other];
          __pipeline_wait_prior(0);
        }) == seen);
  CHECK(races_in([](Thread const& t) {  // begun before all have read
          t.c[t.own] = t.a[t.other];
          copy(t.a[t.own], t.b[t.own]);
          __pipeline_wait_prior(0);
        }) == seen);
}
