#include <limits>

#include <mpmpbd/io/summary.hpp>

#include "../catch.hpp"
#include "scratch.hpp"

#if __has_include(<nlohmann/json.hpp>)
using namespace mpmpbd::io;
using Catch::Matchers::Contains;

TEST_CASE("a summary keeps numbers, units and the order in which it was told", "[io][summary]") {
  Scratch const scratch;
  Json summary;
  summary["peak force"] = quantity(0.1 + 0.2, "N");
  summary["a miss"] = quantity(-0.0123, "m");
  write_json(scratch / "summary.json", summary);
  Json const back = read_json(scratch / "summary.json");
  CHECK(back == summary);
  CHECK(back["peak force"]["value"].get<double>() == 0.1 + 0.2);
  CHECK(back.begin().key() == "peak force");
}

TEST_CASE("a number that is not finite is named, not dropped", "[io][summary]") {
  Scratch const scratch;
  double const infinity = std::numeric_limits<double>::infinity();
  Json summary = {
      {"tension", {quantity(std::numeric_limits<double>::quiet_NaN(), "N"), infinity, -infinity}}};
  write_json(scratch / "summary.json", summary);
  Json const back = read_json(scratch / "summary.json");
  CHECK(back["tension"][0]["value"] == "nan");
  CHECK(back["tension"][1] == "inf");
  CHECK(back["tension"][2] == "-inf");
}

TEST_CASE("a truncated summary is refused with its path", "[io][summary]") {
  Scratch const scratch;
  write_file(scratch / "cut.json", R"({"peak force": {"val)");
  CHECK_THAT(complaint<FileError>([&] { read_json(scratch / "cut.json"); }),
             Contains((scratch / "cut.json").string()));
  write_file(scratch / "large.json", R"({"peak force": 1e999})");
  CHECK_THAT(complaint<FileError>([&] { read_json(scratch / "large.json"); }),
             Contains("large.json"));
}
#endif
