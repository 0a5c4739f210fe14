// Settings files: understood completely or refused with file, line, key, value and what is allowed.
#include <mpmpbd/io/config.hpp>

#include "catch.hpp"
#include "scratch.hpp"

using namespace mpmpbd;

namespace {

struct Wire {
  double radius = 0.001;
  int beads = 20;
  bool round = true;
  std::string kind = "nylon";
  Vec3<double> place{};
  Vec<int, 3> cells{{1, 2, 3}};

  void declare(ConfigKeys& keys) {
    keys(radius, bound::positive("radius_m", "m"), "radius of the wire");
    keys(beads, bound::between("beads", "1", 2, 1000), "points along it");
    keys(round, "round", "whether its section is a circle");
    keys(kind, "kind", "what it is made of", {"nylon", "silk"});
    keys(place, bound::any("place_m", "m"), "where it is");
    keys(cells, bound::between("cells", "1", 1, 100), "cells around it");
  }
  bool operator==(Wire const&) const = default;
};

struct Settings {
  std::int64_t seed = 1;
  double half = 0.05;
  Wire wire;

  void declare(ConfigKeys& keys) {
    keys(seed, bound::between("seed", "1", 0, 1e15), "seed of the random numbers");
    keys(half, bound::positive("half_m", "m"), "half of the room");
    keys.table(wire, "wire", "The wire.");
  }
  void check(ConfigRules& rules) const {
    rules.number("wire.radius_m", wire.radius, {.high = half}, "it fits into the room");
    rules.require("wire.kind", wire.kind != "silk" || wire.round, "silk is round; give \"nylon\"");
  }
  bool operator==(Settings const&) const = default;
};

struct Named {
  std::string name;
  void declare(ConfigKeys& keys) { keys.required(name, "name", "name of the run"); }
};

std::string refusal(std::string const& text) {
  return complaint<ConfigError>([&] { io::parse_config<Settings>(text + "\n", "a.toml"); });
}

}  // namespace

TEST_CASE("a settings file is read, and what it leaves out keeps its default", "[io][config]") {
  auto const s = io::parse_config<Settings>(R"(
seed = 7
[wire]
radius_m = 2e-3
kind = "silk"
place_m = [1, 2.5, -3e-2]   # whole numbers are numbers
)",
                                            "a.toml");
  REQUIRE(s.seed == 7);
  REQUIRE(s.half == 0.05);
  REQUIRE(s.wire.radius == 2e-3);
  REQUIRE(s.wire.beads == 20);
  REQUIRE(s.wire.kind == "silk");
  REQUIRE(s.wire.place == vec(1.0, 2.5, -0.03));
}

TEST_CASE("each mistake in a file has its sentence", "[io][config]") {
  REQUIRE(refusal("[wire]\nradius_m = -1") ==
          "a.toml:2: wire.radius_m = -1 m is not allowed; give a number in (0, inf) m");
  REQUIRE(refusal("[wire]\nradius_m = nan") ==
          "a.toml:2: wire.radius_m = nan m is not allowed; give a number in (0, inf) m");
  REQUIRE(refusal("[wire]\nradius_m = inf") ==
          "a.toml:2: wire.radius_m = inf m is not allowed; give a number in (0, inf) m");
  REQUIRE(refusal("[wire]\n\nradius_m = \"thin\"") ==
          "a.toml:3: wire.radius_m = \"thin\" is a text; give a number in (0, inf) m");
  REQUIRE(
      refusal("[wire]\nbeads = 20.0") ==
      "a.toml:2: wire.beads = 20.0 is a number with a fraction; give a whole number in [2, 1000]");
  REQUIRE(refusal("[wire]\nbeads = 99999999999") ==
          "a.toml:2: wire.beads = 99999999999 is not allowed; give a whole number in [2, 1000]");
  REQUIRE(refusal("[wire]\nround = 1") ==
          "a.toml:2: wire.round = 1 is a whole number; give true or false");
  REQUIRE(refusal("[wire]\nkind = \"steel\"") ==
          "a.toml:2: wire.kind = \"steel\" is not allowed; give one of \"nylon\", \"silk\"");
  REQUIRE(
      refusal("[wire]\nplace_m = [1, 2]") ==
      "a.toml:2: wire.place_m = [1, 2] is a list of 2; give 3 numbers, [x, y, z], each in (-inf, inf) m");
  REQUIRE(
      refusal("[wire]\ncells = [1, 0, 2]") ==
      "a.toml:2: wire.cells = [1, 0, 2] is not allowed; give 3 whole numbers, [x, y, z], each in [1, 100]");
  REQUIRE(refusal("wire = 3") == "a.toml:1: wire is a whole number; it is a table, write [wire]");
  REQUIRE(refusal("[wire]\nraduis_m = 1") ==
          "a.toml:2: key wire.raduis_m is not known; did you mean wire.radius_m?");
  REQUIRE(refusal("radius_m = 1") ==
          "a.toml:1: key radius_m is not known; did you mean wire.radius_m?");
  REQUIRE(refusal("gravity = 9.81") == "a.toml:1: key gravity is not known; take it out");
  REQUIRE(refusal("[wier]\nbeads = 3") == "a.toml:1: table wier is not known; did you mean wire?");
  REQUIRE(
      refusal("seed = 1\nseed = 2") ==
      "a.toml:2: Error while parsing key-value pair: cannot redefine existing integer 'seed'; write TOML 1.0");
  REQUIRE_THAT(refusal("seed = 1\n[wire"), Catch::Contains("a.toml:2: "));
  REQUIRE(refusal("\"a\\u0000\\nb\" = 1") == "a.toml:1: key a??b is not known; take it out");
}

// A double holds whole numbers up to 2^53 exactly; beyond, toml++ hands out none.
TEST_CASE("large whole numbers are numbers", "[io][config]") {
  REQUIRE_THAT(refusal("seed = 9223372036854775807"),
               Catch::Contains("seed = 9223372036854775807 is not"));
  auto const s = io::parse_config<Settings>(
      "wire.place_m = [0, 9007199254740993, -9223372036854775807]", "a.toml");
  REQUIRE(s.wire.place == vec(0.0, 9007199254740992.0, -9223372036854775808.0));
}

// Every dot of a key is a table within a table.
TEST_CASE("tables nested without end do not end the program", "[io][config]") {
  std::string const deep(100, '.');
  REQUIRE_THAT(refusal("seed = 1  # " + deep + "\nwire.beads = 1"),
               Catch::Contains("wire.beads = 1 is not"));
  std::string key = "a";
  for (int n = 0; n < 200000; ++n) key += ".a";
  REQUIRE(refusal("seed = 1\n" + key + " = 1") ==
          "a.toml:2: more than 100 dots in a line; a key has one or two");
  // The deepest that is left: 254 values within each other, every second with a key of 100 tables.
  std::string nested = "x = ", end;
  for (int level = 0; level < 127; ++level) {
    nested += "[\n{ a";
    for (int dot = 0; dot < 99; ++dot) nested += ".a";
    nested += " = ";
    end += " }\n]";
  }
  REQUIRE(refusal(nested + "1" + end) == "a.toml:1: key x is not known; take it out");
}

TEST_CASE("rules between keys name the key, its line and the range they leave", "[io][config]") {
  REQUIRE(
      refusal("half_m = 0.01\n[wire]\nradius_m = 0.02") ==
      "a.toml:3: wire.radius_m = 0.02 m is not allowed; give a number in (0, 0.01] m: it fits into the room");
  REQUIRE(
      refusal("half_m = 0.0001") ==
      "a.toml: wire.radius_m = 0.001 m is not allowed; give a number in (0, 0.0001] m: it fits into the room (the value is the default)");
  REQUIRE(refusal("[wire]\nkind = \"silk\"\nround = false") ==
          "a.toml:2: wire.kind = \"silk\" is not allowed; silk is round; give \"nylon\"");
}

TEST_CASE("all mistakes of a file are reported together, in its order", "[io][config]") {
  try {
    io::parse_config<Settings>("seed = -1\nhalf_m = 1e-4\n[wire]\nbeeds = 2\nround = \"yes\"",
                               "a.toml");
    FAIL("taken");
  } catch (ConfigError const& error) {
    REQUIRE(error.messages.size() == 4);
    REQUIRE_THAT(error.messages[0], Catch::Contains("wire.radius_m"));  // a rule, on a default
    REQUIRE_THAT(error.messages[1], Catch::StartsWith("a.toml:1: seed = -1"));
    REQUIRE_THAT(error.messages[2], Catch::StartsWith("a.toml:4: key wire.beeds"));
    REQUIRE_THAT(error.messages[3], Catch::StartsWith("a.toml:5: wire.round"));
  }
}

TEST_CASE("settings written to a file read back the same", "[io][config]") {
  Settings s;
  s.seed = 123456789012345;
  s.half = 0.1 + 0.2;
  s.wire.radius = 1e-7 / 3;
  s.wire.round = false;
  s.wire.place = vec(1.0, 1e22, -5e-324);
  auto const text = io::config_text(s);
  INFO(text);
  REQUIRE(io::parse_config<Settings>(text, "written") == s);
  REQUIRE_THAT(text, Catch::Contains("# The wire.\n[wire]\n"));
  REQUIRE_THAT(text, Catch::Contains("beads = 20  # points along it; a whole number in [2, 1000]"));

  Scratch scratch;
  io::write_config(scratch / "s.toml", s);
  REQUIRE(io::read_config<Settings>(scratch / "s.toml") == s);
  auto const changed = io::read_config<Settings>(scratch / "s.toml", {"wire.beads = 3", "seed=4"});
  REQUIRE(changed.wire.beads == 3);
  REQUIRE(changed.seed == 4);
  REQUIRE(complaint<ConfigError>([&] {
            io::read_config<Settings>(scratch / "s.toml", {"wire.beads = 1"});
          }) == "--set: wire.beads = 1 is not allowed; give a whole number in [2, 1000]");
  REQUIRE_THROWS_AS(io::read_config<Settings>(scratch / "none.toml"), io::FileError);
}

TEST_CASE("text is written so that TOML reads it back", "[io][config]") {
  Named n;
  n.name = "a \"b\" \\ c\nd\x01";
  REQUIRE(io::parse_config<Named>(io::config_text(n), "written").name == n.name);
}

TEST_CASE("a key without default must be given", "[io][config]") {
  REQUIRE(complaint<ConfigError>([] { io::parse_config<Named>("", "a.toml"); }) ==
          "a.toml: key name is missing; give a text, name of the run");
  REQUIRE_THAT(complaint<ConfigError>([] { io::parse_config<Named>({}); }),
               Catch::Contains("settings without a document: key name is missing"));
  REQUIRE(io::parse_config<Named>("name = \"x\"", "a.toml").name == "x");
}

TEST_CASE("settings made by a program obey the same bounds and rules", "[io][config]") {
  Settings s;
  REQUIRE_NOTHROW(check_config(s));
  s.wire.beads = 1;
  REQUIRE(complaint<ConfigError>([&] { check_config(s); }) ==
          "wire.beads = 1 is not allowed; give a whole number in [2, 1000]");
  s = {};
  s.wire.radius = 1.0;
  REQUIRE(
      complaint<ConfigError>([&] { check_config(s); }) ==
      "wire.radius_m = 1 m is not allowed; give a number in (0, 0.05] m: it fits into the room");
}
