// Fields of a run seen where they lie: the same numbers as by get(), at the same place after a step.
#include "catch.hpp"

#include <memory>
#include <set>
#include <utility>

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog.hpp>
#include <mpmpbd/core/array.hpp>
#include <mpmpbd/io/dlpack.hpp>

using namespace mpmpbd;
using Catch::Matchers::Contains;

namespace {

using Run = Simulation<catalog::Suture, Threads, float>;

// Two threads of five beads that differ, in three environments.
Run hanging() {
  RodAssembly<catalog::ElasticThread> rod;
  std::vector<Vec3<double>> line;
  for (int i = 0; i < 5; ++i) line.push_back({{0.01 * i, 0.03, 0.02 - 0.001 * i}});
  add_thread(rod, std::span<Vec3<double> const>(line), RodMaterial{2e9, 1.15e-4, 1140.0});
  Run run({.environments = 3, .capacity = rod.capacity()});
  for (std::int64_t env = 0; env < 3; ++env) {
    rod.write(run.state(), env);
    run.state().set<bead::Velocity>(env, 4, vec(0.1f * float(env), 0.0f, 0.3f));
  }
  return run;
}

template <class T> T at(Array const& a, std::int64_t env, std::int64_t slot, std::int64_t c) {
  return static_cast<T const*>(a.data)[env * a.strides[0] + slot * a.strides[1] + c * a.strides[2]];
}

}  // namespace

TEST_CASE("a field is found where it lies, by type and by name", "[scene][arrays]") {
  auto run = hanging();
  auto const x = run.array<bead::Position>();
  REQUIRE(x.axes == 3);
  CHECK(x.shape[0] == 3);
  CHECK(x.shape[1] == 5);
  CHECK(x.shape[2] == 3);
  CHECK(x.size() == 45);
  CHECK(x.element == element_type<float>);
  CHECK(x.place.memory == MemorySpace::host);
  for (int step = 0; step < 2; ++step) {
    for (std::int64_t env = 0; env < 3; ++env)
      for (std::int64_t slot = 0; slot < 5; ++slot)
        for (int c = 0; c < 3; ++c)
          CHECK(at<float>(x, env, slot, c) == run.state().get<bead::Position>(env, slot)[c]);
    run.step(0.004);
  }
  CHECK(array_named(run, "bead.x").data == x.data);
  CHECK(at<float>(x, 2, 4, 0) != at<float>(x, 0, 4, 0));

  auto const status = run.array<environment::Status>();
  CHECK(status.element == element_type<std::int64_t>);
  CHECK(status.shape[2] == 1);
}

TEST_CASE("what a const run shows is read-only", "[scene][arrays]") {
  auto run = hanging();
  CHECK_FALSE(run.array<bead::Velocity>().read_only);
  CHECK(std::as_const(run).array<bead::Velocity>().read_only);
  CHECK(array_named(std::as_const(run), "bead.v").read_only);
}

#if defined(MPMPBD_HAS_DLPACK)
TEST_CASE("a run lives as long as a tensor of its field", "[scene][arrays][dlpack]") {
  auto run = std::make_shared<Run>(hanging());
  auto const* const numbers = run->array<bead::Position>().data;
  DLManagedTensor* tensor = io::to_dlpack(run->array<bead::Position>(), run);
  std::weak_ptr<Run> const watch = run;
  run.reset();
  CHECK_FALSE(watch.expired());
  CHECK(tensor->dl_tensor.data == numbers);
  CHECK(static_cast<float const*>(tensor->dl_tensor.data)[4] == 0.04f);  // x of the last bead
  tensor->deleter(tensor);
  CHECK(watch.expired());
}
#endif

TEST_CASE("a field that is not stored is refused with those that are", "[scene][arrays]") {
  auto const run = hanging();
  CHECK_THROWS_WITH(array_named(run, "particle.x"),
                    Contains("no field 'particle.x' is stored") && Contains("bead.x, "));
}

TEST_CASE("no two fields of a ready-made scene have the same name", "[scene][arrays]") {
  auto check = []<class Scene>(std::type_identity<Scene>) {
    std::set<std::string> names;
    for_each_lasting_field(typename State<float, typename Scene::StateFields>::List{},
                           [&]<class F>(F) { CHECK(names.insert(full_name<F>()).second); });
  };
  check(std::type_identity<catalog::Tissue>{});
  check(std::type_identity<catalog::Suture>{});
  check(std::type_identity<Suturing>{});
}

TEST_CASE("arrays without gaps have the last axis fastest", "[scene][arrays]") {
  std::vector<double> const numbers(24);
  std::int64_t const shape[] = {2, 3, 4};
  auto const all = contiguous_array(numbers.data(), shape);
  CHECK(all.read_only);
  CHECK(all.element == element_type<double>);
  CHECK(all.strides[0] == 12);
  CHECK(all.strides[1] == 4);
  CHECK(all.strides[2] == 1);
  CHECK(element_type<unsigned char> == ElementType{NumberKind::natural, 1});
  CHECK(element_type<bool> == ElementType{NumberKind::flag, 1});
  CHECK_THROWS_WITH(contiguous_array(numbers.data(), std::vector<std::int64_t>(7, 1)),
                    Contains("7 axes") && Contains("at most 6"));
}
