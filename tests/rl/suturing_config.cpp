// The settings of the suturing task: read from files, and refused where they cannot be.
#include "catch.hpp"

#include "io/scratch.hpp"
#include "rl/suturing.hpp"

using namespace mpmpbd;

namespace {
std::string refusal(std::string const& line) {
  return complaint<ConfigError>([&] { test::suturing_config("coarse.toml", {line}); });
}
}  // namespace

TEST_CASE("preset coarse has the numbers of the issue", "[rl][suturing][config]") {
  auto const c = test::suturing_config("coarse.toml");
  CHECK(c.scene.tissue.point_count() == 2000);
  CHECK(c.episode.decision_interval * c.scene.time.step == Approx(0.08));
  CHECK(c.episode.limit * c.episode.decision_interval == 4000);
  CHECK(c.reach == Approx(0.075));
  CHECK(c.picture.width == 250);
  CHECK(test::suturing_config("paper.toml").scene.tissue.point_count() == 20000);
}

TEST_CASE("a key that there is not is refused by its name", "[rl][suturing][config][errors]") {
  struct Unknown {
    char const *line, *name;
  };
  for (auto const& unknown :
       {Unknown{"reward.bonus=1.0", "bonus"}, Unknown{"episodes.limit=10", "table episodes"},
        Unknown{"random.shift=0.1", "random.shift"}}) {
    auto const sentence = refusal(unknown.line);
    CAPTURE(unknown.line, sentence);
    CHECK(sentence.find(unknown.name) != std::string::npos);
    CHECK(sentence.find("--set") != std::string::npos);  // where it is
  }
}

TEST_CASE("a value that cannot be is refused with its bound", "[rl][suturing][config][errors]") {
  struct Wrong {
    char const *line, *key;
  };
  for (auto const& wrong :
       {Wrong{"reach_m=-0.1", "reach_m"}, Wrong{"episode.limit=0", "limit"},
        Wrong{"episode.frames=2.5", "frames"}, Wrong{"markers.exit_m=[0.3, 0.1, 0.0]", "exit_m"},
        Wrong{"random.height_m=0.1", "height_m"}, Wrong{"out_deg=180.0", "out_deg"},
        Wrong{"random.marker_shift_m=0.7", "marker_shift_m"},
        Wrong{"hand.speed_m_s=\"fast\"", "speed_m_s"},
        Wrong{"random.friction_factor=0.5", "friction_factor"},
        Wrong{"random.marker_closer_m=0.4", "marker_closer_m"},
        Wrong{"random.modulus_factor=9.0", "modulus_factor"}, Wrong{"picture.width=0", "width"},
        Wrong{"motion.approach_deg=200.0", "approach_deg"}}) {
    auto const sentence = refusal(wrong.line);
    CAPTURE(wrong.line, sentence);
    CHECK(sentence.find(wrong.key) != std::string::npos);
  }
}

TEST_CASE("no part of the needle begins in tissue, however it is turned",
          "[rl][suturing][config][errors]") {
  // A long arc that hangs lower between its ends than at any of them.
  std::vector<std::string> lines{"needle.angle_deg=200.0", "random.turn_deg=80.0",
                                 "random.height_m=9.0"};
  auto const c = test::suturing_config("coarse.toml", lines);
  double const least = c.scene.tissue.top()[2] + c.scene.needle.wire_radius +
                       c.scene.needle.radius * c.random.needle_radius -
                       c.scene.script().start.position[2] + c.random.shift;
  auto const with = [&](double height) {
    lines.back() = "random.height_m=" + std::to_string(height);
    test::suturing_config("coarse.toml", lines);
  };
  CHECK_THAT(complaint<ConfigError>([&] { with(least - 1e-3); }), Catch::Contains("height_m"));
  CHECK_NOTHROW(with(least + 1e-3));
}

TEST_CASE("who is not strict may take substeps too long for the stiffest tissue",
          "[rl][suturing][config]") {
  std::vector<std::string> lines{"random.modulus_factor=9.0"};
  auto const read = [&] { test::suturing_config("coarse.toml", lines); };
  CHECK_THAT(complaint<ConfigError>(read), Catch::Contains("time.strict = false"));
  lines.emplace_back("time.strict=false");
  CHECK_NOTHROW(read());
}
