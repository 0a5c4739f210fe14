// B40: checkpoints continue bit for bit; bad files are refused and change nothing.
#include "../catch.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <mpmpbd/io/state_file.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/scene/simulation.hpp>

using namespace mpmpbd;

namespace {

struct Tissue : Mpm<NeoHookean> {};
struct Block : Scene<Tissue> {};

template <class T> Simulation<Block, Serial, T> spinning_block() {
  SimulationOptions options;
  options.environments = 2;
  options.cell_size = 3.7e-3;
  for (int& n : options.nodes) n = 14;
  options.capacity = {{"particle", 700}};
  Simulation<Block, Serial, T> sim(options);
  sim.template set<NeoHookean>(lame(3.1e4, 0.42));
  std::vector<Vec3<double>> x;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i)
        x.push_back({{0.015 + 1.85e-3 * i, 0.016 + 1.85e-3 * j, 0.017 + 1.85e-3 * k}});
  for (std::int64_t e = 0; e < 2; ++e) {
    sim.add_particles(e, x, 1060.0, 1.85e-3 * 1.85e-3 * 1.85e-3);
    for (std::int64_t p = 0; p < 512; ++p) {
      auto const at = sim.state().template get<particle::Position>(e, p);
      sim.state().template set<particle::Velocity>(
          e, p, {{T(-5) * (at[1] - T(0.022)), T(5 + double(e)) * (at[0] - T(0.021)), T(0.01)}});
    }
  }
  return sim;
}

template <class Sim> bool same_bits(Sim const& a, Sim const& b) {
  bool same = true;
  for_each_field(typename Sim::Store::List{}, [&]<class F>(F) {
    using D = typename F::Domain;
    auto const& p = a.state().template table<D>().template planes<F>();
    auto const& q = b.state().template table<D>().template planes<F>();
    same = same && p.size() == q.size() &&
           std::memcmp(p.data(), q.data(), p.size() * sizeof(p[0])) == 0;
  });
  return same;
}

std::string scratch_file(std::string const& name) {
  return (std::filesystem::temp_directory_path() / ("mpmpbd_" + name)).string();
}

std::vector<char> bytes_of(std::string const& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(std::string const& file, std::vector<char> const& bytes) {
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

template <class Store> std::string refusal(std::string const& file) {
  try {
    read_state_file<Store>(file);
  } catch (std::runtime_error const& e) { return e.what(); }
  return "";
}

}  // namespace

TEMPLATE_TEST_CASE("a restored run continues bit for bit", "[io][state_file]", float, double) {
  auto const file = scratch_file("continue.state");
  auto whole = spinning_block<TestType>();
  for (int s = 0; s < 3; ++s) whole.step(2e-4);
  write_state_file(file, whole.state());
  for (int s = 0; s < 3; ++s) whole.step(2e-4);

  auto second = spinning_block<TestType>();
  second.restore(read_state_file<typename decltype(second)::Store>(file));
  REQUIRE_FALSE(same_bits(whole, second));
  for (int s = 0; s < 3; ++s) second.step(2e-4);
  CHECK(same_bits(whole, second));
  std::filesystem::remove(file);
}

TEST_CASE("a damaged or foreign state file is refused with the reason", "[io][state_file]") {
  auto const file = scratch_file("damaged.state");
  auto sim = spinning_block<float>();
  using Store = decltype(sim)::Store;
  write_state_file(file, sim.state());
  auto const good = bytes_of(file);

  for (std::size_t keep :
       {std::size_t{0}, std::size_t{7}, std::size_t{19}, good.size() / 2, good.size() - 1}) {
    write_bytes(file, {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(keep)});
    CHECK(refusal<Store>(file).find("nothing was changed") != std::string::npos);
  }
  for (std::size_t flip : {std::size_t{9}, std::size_t{40}, good.size() / 2, good.size() - 3}) {
    auto bad = good;
    bad[flip] = static_cast<char>(bad[flip] ^ 0x10);
    write_bytes(file, bad);
    CHECK(refusal<Store>(file).find("nothing was changed") != std::string::npos);
  }
  auto longer = good;
  longer.push_back('x');
  write_bytes(file, longer);
  CHECK(refusal<Store>(file).find("corrupted") != std::string::npos);

  auto foreign = good;
  foreign[0] = 'X';
  write_bytes(file, foreign);
  CHECK(refusal<Store>(file).find("is not a state file of mpmpbd") != std::string::npos);
  std::filesystem::remove(file);
  CHECK(refusal<Store>(file).find("cannot be opened") != std::string::npos);
}

namespace {
// The numbers of a state file after its description, and its checksum.
struct Forged {
  std::vector<char> bytes;
  explicit Forged(std::vector<char> const& good) : bytes(good) {}
  std::size_t after_description() const {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return 16 + length;
  }
  Forged& version(std::uint32_t number) {
    std::memcpy(bytes.data() + state_file_magic.size(), &number, sizeof number);
    return *this;
  }
  // Writes a number of 8 bytes, so many numbers after the description, and the checksum that fits.
  Forged& put(std::size_t place, std::int64_t number) {
    std::memcpy(bytes.data() + after_description() + 8 * place, &number, sizeof number);
    auto const sum = mpmpbd::detail::fnv1a(bytes.data(), bytes.size() - 8);
    std::memcpy(bytes.data() + bytes.size() - 8, &sum, sizeof sum);
    return *this;
  }
};
}  // namespace

// The checksum is right, the numbers are not: nothing may be allocated or counted by them.
TEST_CASE("a state file that describes more than it holds is refused", "[io][state_file]") {
  auto const file = scratch_file("forged.state");
  auto sim = spinning_block<float>();
  using Store = decltype(sim)::Store;
  write_state_file(file, sim.state());
  auto const good = bytes_of(file);
  auto const said = [&](std::size_t place, std::int64_t number) {
    write_bytes(file, Forged(good).put(place, number).bytes);
    return refusal<Store>(file);
  };
  enum : std::size_t { environments, capacity, live };  // of the first table
  std::int64_t const huge = std::int64_t{1} << 62;
  for (std::int64_t const count : {huge, -huge, std::int64_t{-1}, std::int64_t{1} << 40}) {
    CAPTURE(count);
    CHECK(said(environments, count).find("which it does not hold") != std::string::npos);
    CHECK(said(capacity, count).find("which it does not hold") != std::string::npos);
    CHECK(said(live, count).find("items in use, of") != std::string::npos);
  }
  CHECK(said(environments, 2).empty());  // what it was
  // Whole and of another version: its numbers may mean something else.
  for (std::uint32_t const version : {state_file_version - 1, state_file_version + 1}) {
    write_bytes(file, Forged(good).version(version).put(environments, 2).bytes);
    CHECK(refusal<Store>(file).find("has format version " + std::to_string(version) +
                                    ", this library reads version") != std::string::npos);
  }
  auto foreign = good;
  foreign[16] = '\0';  // of the description; a message with it would end there
  write_bytes(file, Forged(foreign).put(environments, 2).bytes);
  CHECK(refusal<Store>(file).find("it holds '?calar 4' where this scene has 'scalar 4'; nothing") !=
        std::string::npos);
  CHECK(refusal<Store>(std::filesystem::temp_directory_path().string()).find("is not a file") !=
        std::string::npos);
  std::filesystem::remove(file);
}

TEST_CASE("a state of another scene, precision or size is refused", "[io][state_file]") {
  auto const file = scratch_file("other.state");
  auto sim = spinning_block<float>();
  write_state_file(file, sim.state());
  using Double = Simulation<Block, Serial, double>::Store;
  CHECK(refusal<Double>(file).find(
            "another scene: it holds 'scalar 4' where this scene has 'scalar 8'") !=
        std::string::npos);

  SimulationOptions options;
  options.cell_size = 3.7e-3;
  for (int& n : options.nodes) n = 14;
  options.capacity = {{"particle", 700}};
  Simulation<Block, Serial, float> single(options);
  auto const before = single.state().get<environment::Step>(0);
  std::string why;
  try {
    single.restore(read_state_file<decltype(single)::Store>(file));
  } catch (std::invalid_argument const& e) { why = e.what(); }
  CHECK(why.find("a state of 2 environments given; this run has 1") != std::string::npos);
  CHECK(single.state().get<environment::Step>(0) == before);
  std::filesystem::remove(file);
}
