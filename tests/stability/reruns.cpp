// B42, on the CPU: the same bits from every run, in a process of its own, with any number of threads and with
// or without vector kernels.
// seconds: 12
// processors: 2
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/effects/gravity.hpp>

#include "catch.hpp"
#include "io/scratch.hpp"
#include "physics/thread_in_gel.hpp"

using namespace test;

namespace {

struct Stitched : Scene<Gel, ThreadInGel::Rods, Coupling<Embedded, Friction, Drag>, Gravity> {};

// FNV-1a of all numbers of a state.
template <class Store> std::uint64_t hash_of(Store const& state) {
  std::uint64_t hash = 14695981039346656037u;
  for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
    for_each_field(on_t<typename Store::List, D>{}, [&]<class F>(F) {
      auto const& numbers = state.template table<D>().template planes<F>();
      auto const* bytes = reinterpret_cast<unsigned char const*>(numbers.data());
      for (std::size_t i = 0; i < numbers.size() * sizeof(numbers[0]); ++i)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    });
  });
  return hash;
}

// Gel with a thread that is thrown about, in so many environments.
std::uint64_t run_once(Threads backend, int environments) {
  ThreadInGel thread;
  thread.block.environments = environments;
  thread.block.substeps = 0;
  auto run = thread.make<Stitched, float>(backend);
  run.set<Friction>({0.2, 500.0});
  run.set<Drag>({0.2});
  run.set<Gravity>({{0.0, 0.5, -2.0}});
  for (int e = 0; e < environments; ++e)
    for (std::int64_t k = 0; k < thread.beads(); ++k)
      run.state().set<bead::Velocity>(e, k,
                                      vec(0.05f, -0.1f, 0.02f * static_cast<float>(k % 5 + e)));
  for (int s = 0; s < 40; ++s) run.step(1e-3);
  for (int e = 0; e < environments; ++e) CHECK(run.status(e) == 0);
  return hash_of(run.state());
}

char const* const result_file = "MPMPBD_RERUN_RESULT";

}  // namespace

// Not a test of its own: what the other processes do.
TEST_CASE("write the hash of a run to a file", "[.rerun]") {
  auto const* path = std::getenv(result_file);
  REQUIRE(path != nullptr);
  std::ofstream(path) << run_once(Threads{2}, 1);
}

TEST_CASE("threads and vector kernels do not change a bit", "[stability][B42]") {
  for (int const environments : {1, 3}) {
    auto const reference = run_once(Threads{1, Kernels::plain}, environments);
    for (int const threads : {1, 2, 4})
      CHECK(run_once(Threads{threads}, environments) == reference);
    CHECK(run_once(Threads{2}, environments) == reference);  // once more
  }
}

#if defined(__linux__)
TEST_CASE("five processes give the same bits", "[stability][B42]") {
  ::Scratch const scratch;
  auto const file = scratch / "hash";
  auto const program = std::filesystem::read_symlink("/proc/self/exe").string();
  auto const command = "\"" + program + "\" \"[.rerun]\" > /dev/null";
  ::setenv(result_file, file.c_str(), 1);
  auto const here = std::to_string(run_once(Threads{1}, 1));
  for (int i = 0; i < 5; ++i) {
    REQUIRE(std::system(command.c_str()) == 0);
    std::string there;
    std::ifstream(file) >> there;
    CHECK(there == here);
  }
}
#endif
