// The presets of the stitch: both are read, say what their comments claim, and refuse what cannot be.
#include <mpmpbd/catalog/suturing_config.hpp>
#include <mpmpbd/io/config.hpp>

#include "catch.hpp"
#include "io/scratch.hpp"
#include "support/scenes.hpp"

using namespace mpmpbd;

namespace {

std::filesystem::path preset(std::string const& name) { return test::scenes() / (name + ".toml"); }
SuturingConfig read(std::string const& name) {
  return io::read_config<SuturingConfig>(preset(name));
}

// The file with the value of one key replaced, read as "scene.toml".
std::string edited(std::string const& name, std::string const& table, std::string const& key,
                   std::string const& value) {
  std::string text = io::read_file(preset(name));
  std::size_t at = text.find("\n[" + table + "]");
  REQUIRE(at != std::string::npos);
  at = text.find("\n" + key + " = ", at);
  REQUIRE(at != std::string::npos);
  at += key.size() + 4;
  std::size_t const end = text.find('\n', at);
  text.replace(at, end - at, value);
  return text;
}
std::string refusal(std::string const& text) {
  return complaint<ConfigError>([&] { io::parse_config<SuturingConfig>(text, "scene.toml"); });
}
std::string refusal_of(std::string const& table, std::string const& key, std::string const& value) {
  return refusal(edited("paper", table, key, value));
}

}  // namespace

TEST_CASE("preset paper has the numbers of the reference system", "[catalog][preset]") {
  auto const c = read("paper");
  REQUIRE(c.tissue.point_count() == 20000);
  REQUIRE(c.tissue.positions().size() == 20000);
  REQUIRE(c.tissue.lame().lambda == Approx(714285.8).epsilon(1e-6));
  REQUIRE(c.tissue.lame().mu == Approx(178571.4).epsilon(1e-6));
  REQUIRE(c.tissue.point_count() * c.tissue.point_volume() == Approx(2.0));
  REQUIRE(c.domain.nodes() == Vec<int, 3>{{31, 21, 19}});
  REQUIRE(c.steps() == 2500);
  REQUIRE(c.path().angle * 180 / pi<double> == Approx(139.3).epsilon(1e-3));
  REQUIRE(c.path().depth == Approx(0.209).epsilon(2e-3));
  REQUIRE(norm(c.entry() - vec(1.2, 1.0, 1.3)) < 1e-12);
  REQUIRE(c.script().duration() == Approx(10.0));
  // Without viscosity the limit is dx sqrt(rho (1 - 2 nu)/E) = 2 ms.
  auto dry = c;
  dry.tissue.viscosity = 0;
  REQUIRE(dry.stable_dt() == Approx(0.002).epsilon(1e-12));
  REQUIRE(c.stable_dt() == Approx(0.82 * 0.002).epsilon(1e-3));
  REQUIRE(c.time.step / c.time.substeps < 0.8 * c.stable_dt());
}

TEST_CASE("preset phantom has the numbers of the bench", "[catalog][preset]") {
  auto const c = read("phantom");
  auto const material = c.thread.material();
  REQUIRE(material.bending_stiffness() == Approx(0.003 * 2.75e-7).epsilon(2e-3));
  REQUIRE(material.axial_stiffness() == Approx(83.1).epsilon(1e-3));
  REQUIRE(c.tissue.point_count() == 20000);
  auto dry = c;
  dry.tissue.viscosity = 0;
  REQUIRE(dry.stable_dt() == Approx(1.19e-4).epsilon(2e-3));
  REQUIRE(c.time.step / c.time.substeps < c.stable_dt());
  REQUIRE(c.time.step / c.time.substeps < 0.8 * dry.stable_dt());
}

TEST_CASE("the presets are similar, as their comments say", "[catalog][preset]") {
  auto const paper = read("paper"), phantom = read("phantom");
  double const length = 50, modulus = 500.0 / 30.0, force = modulus * length * length;
  auto scaled = [](double a, double b, double by) { return std::abs(a / (b * by) - 1.0) < 0.005; };
  REQUIRE(scaled(paper.needle.puncture_force, phantom.needle.puncture_force, force));
  REQUIRE(scaled(paper.needle.cutting_force, phantom.needle.cutting_force, force));
  REQUIRE(scaled(paper.contact.clamp_pressure, phantom.contact.clamp_pressure, modulus));
  REQUIRE(scaled(paper.contact.drag, phantom.contact.drag, modulus));
  REQUIRE(scaled(paper.thread.material().axial_stiffness(),
                 phantom.thread.material().axial_stiffness(), force));
  REQUIRE(scaled(paper.thread.material().bending_stiffness(),
                 phantom.thread.material().bending_stiffness(), force * length * length));
  REQUIRE(scaled(paper.needle.radius, phantom.needle.radius, length));
  REQUIRE(scaled(paper.thread.length, phantom.thread.length, length));
  REQUIRE(scaled(paper.domain.size[2], phantom.domain.size[2], length));
  REQUIRE(scaled(norm(paper.camera.eye), norm(phantom.camera.eye), length));
  for (auto const& c : {paper, phantom}) {
    REQUIRE(c.dimple() < c.domain.cell_size);
    REQUIRE(c.dimple() == Approx(0.72 * c.domain.cell_size).epsilon(0.01));
  }
}

TEST_CASE("a preset written to a file reads back the same", "[catalog][preset]") {
  for (auto const* name : {"paper", "phantom"}) {
    auto const c = read(name);
    REQUIRE(io::parse_config<SuturingConfig>(io::config_text(c), "written") == c);
    REQUIRE_NOTHROW(check_config(c));
  }
  // The defaults of the struct are preset paper, but for rounded moduli.
  REQUIRE_NOTHROW(check_config(SuturingConfig{}));
}

TEST_CASE("impossible scenes are refused by file, line, key, value and range",
          "[catalog][preset]") {
  REQUIRE(refusal_of("tissue", "poisson_ratio", "0.5") ==
          "scene.toml:11: tissue.poisson_ratio = 0.5 is not allowed; give a number in [0, 0.5)");
  REQUIRE(
      refusal_of("tissue", "density_kg_m3", "-1000") ==
      "scene.toml:12: tissue.density_kg_m3 = -1000 kg/m^3 is not allowed; give a number in (0, inf) kg/m^3");
  REQUIRE(
      refusal_of("tissue", "young_modulus_pa", "\"soft\"") ==
      "scene.toml:10: tissue.young_modulus_pa = \"soft\" is a text; give a number in (0, inf) Pa");
  REQUIRE(
      refusal_of("tissue", "young_modulus_pa", "1\nyoung_modulus = 1")
          .find(
              "scene.toml:11: key tissue.young_modulus is not known; did you mean tissue.young_modulus_pa?") !=
      std::string::npos);
  auto const dt = refusal_of("time", "substeps", "2");
  INFO(dt);
  REQUIRE_THAT(
      dt,
      Catch::StartsWith(
          "scene.toml:25: time.substeps = 2 is not allowed; give a number in [3, 1000000]: a substep may last 0.00164 s here (give 4"));
  REQUIRE(refusal_of("time", "substeps", "0").empty());
  REQUIRE(refusal(edited("paper", "time", "substeps", "2") + "\n").size() > 0);
  {
    std::string text = edited("paper", "time", "substeps", "2");
    text.replace(text.find("strict = true"), 13, "strict = false");
    REQUIRE(refusal(text).empty());
  }
  REQUIRE(
      refusal_of("needle", "radius_m", "1.2") ==
      "scene.toml:29: needle.radius_m = 1.2 m is not allowed; give a number in (0, 0.9] m: the needle is not larger than the domain");
  auto all = [](std::string const& table, std::string const& key, std::string const& value) {
    return refusal_of(table, key, value);
  };
  REQUIRE_THAT(
      all("markers", "exit_m", "[1.1, 0.0, 0.0]"),
      Catch::Contains(
          "markers.exit_m = 1.1 m is not allowed; give a number in [-0.9625, 0.9625] m: the marker lies on the tissue"));
  REQUIRE_THAT(all("markers", "exit_m", "[0.5, 0.0, 0.0]"),
               Catch::Contains("too far for a needle of radius 0.32 m; give at most 0.64 m"));
  REQUIRE_THAT(all("markers", "exit_m", "[-0.30, 0.0, 0.0]"), Catch::Contains("overlap"));
  REQUIRE_THAT(
      all("needle", "cutting_force_n", "7000.0"),
      Catch::Contains(
          "needle.cutting_force_n = 7000 N is not allowed; give a number in [0, 6250] N: cutting takes less"));
  REQUIRE_THAT(
      all("needle", "puncture_force_n", "16000.0"),
      Catch::Contains(
          "needle.puncture_force_n = 16000 N is not allowed; give a number in (0, 10500] N"));
  REQUIRE_THAT(all("needle", "angle_deg", "120.0"), Catch::Contains("needle.angle_deg = 120 deg"));
  REQUIRE_THAT(all("thread", "length_m", "1.0"),
               Catch::Contains("thread.length_m = 1 m is not allowed; give a number in [1.1"));
  REQUIRE_THAT(all("thread", "beads", "10"),
               Catch::Contains("thread.beads = 10 is not allowed; give a number in [17, 100000]"));
  REQUIRE_THAT(all("thread", "density_kg_m3", "0"),
               Catch::Contains("thread.density_kg_m3 = 0 kg/m^3"));
  REQUIRE_THAT(
      all("tissue", "size_m", "[2.8, 1.0, 1.0]"),
      Catch::Contains("tissue.size_m = 2.8 m is not allowed; give a number in [0.1, 2.6] m"));
  REQUIRE_THAT(all("tissue", "points", "[10, 20, 25]"),
               Catch::Contains("tissue.points = 10 is not"));
  REQUIRE_THAT(all("domain", "size_m", "[3.05, 2.0, 1.8]"),
               Catch::Contains("give a whole number of cells of 0.1 m along x"));
  REQUIRE_THAT(all("domain", "cell_size_m", "0.0"), Catch::Contains("domain.cell_size_m = 0.0 m"));
  REQUIRE_THAT(all("motion", "approach_deg", "60.0"),
               Catch::Contains("motion.approach_deg = 60 deg"));
  REQUIRE_THAT(all("output", "width", "8"), Catch::Contains("output.width = 8 is not allowed"));
}

// What other parts would refuse, or count wrongly, is refused here and with the other mistakes.
TEST_CASE("scenes of numbers beyond all use are refused as scenes", "[catalog][preset]") {
  auto const text = [](std::string const& more) { return refusal(more + "\n"); };
  CHECK_THAT(text("tissue.points = [4096, 4096, 4096]"), Catch::Contains("less than 5e8"));
  CHECK_THAT(text("time.step_s = 1e300"), Catch::Contains("time.step_s = 1e+300 s"));
  CHECK_THAT(text("time.step_s = 1e-300"), Catch::Contains("time.step_s = 1e-300 s"));
  CHECK_THAT(text("domain.cell_size_m = 1e-200"), Catch::Contains("5e8 cells"));
  CHECK_THAT(text("tissue.young_modulus_pa = 1e300"), Catch::Contains("time.substeps = 4"));
  // Markers above each other have no path, markers a needle's diameter apart have one or none by rounding.
  CHECK_THAT(text("markers.entry_m = [0, 0, 0]\nmarkers.exit_m = [1e-9, 0, 0.3]"),
             Catch::Contains("markers are on the top surface"));
  CHECK_THAT(text("markers.entry_m = [-0.32, 0, 0]\nmarkers.exit_m = [0.32, 0, 0]"),
             Catch::Contains("markers.exit_m"));
  CHECK_THAT(text("needle.angle_deg = 90.0\nmotion.approach_deg = 300"),
             Catch::Contains("motion.approach_deg = 300"));
}

TEST_CASE("several mistakes in a scene are told at once", "[catalog][preset]") {
  try {
    io::parse_config<SuturingConfig>(
        "[tissue]\npoisson_ratio = 0.5\ndensity_kg_m3 = -1\n[needle]\nradius_m = 1.2\nradios_m = 3\n[markers]\nentry_m = [0.0]",
        "scene.toml");
    FAIL("taken");
  } catch (ConfigError const& error) {
    INFO(error.what());
    REQUIRE(error.messages.size() == 5);
    std::array<int, 5> const lines{2, 3, 5, 6, 8};
    for (std::size_t i = 0; i < 5; ++i)
      REQUIRE_THAT(error.messages[i], Catch::StartsWith(fmt::format("scene.toml:{}:", lines[i])));
  }
}
