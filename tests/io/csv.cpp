#include <limits>

#include <mpmpbd/io/csv.hpp>

#include "../catch.hpp"
#include "scratch.hpp"

using namespace mpmpbd::io;
using Catch::Matchers::Contains;

TEST_CASE("a CSV file has names with units, then numbers that read back exactly", "[io][csv]") {
  Scratch const scratch;
  double const force = 0.1 + 0.2;  // 0.30000000000000004
  Csv csv(scratch / "force.csv", {{"time", "s"}, {"force, needle", "N"}, {"hits", "1"}});
  csv.row({0.004, force, 12345678});
  csv.row({0.008, std::numeric_limits<double>::quiet_NaN(), -1e-300});
  csv.close();
  std::string const text = read_file(scratch / "force.csv");
  CHECK(
      text ==
      "time [s],\"force, needle [N]\",hits [1]\n0.004,0.30000000000000004,12345678\n0.008,nan,-1e-300\n");
}

TEST_CASE("a row of the wrong width is refused with both numbers", "[io][csv]") {
  Scratch const scratch;
  Csv csv(scratch / "force.csv", {{"time", "s"}, {"force", "N"}});
  CHECK_THAT(complaint<std::invalid_argument>([&] {
               csv.row({1.0, 2.0, 3.0});
             }),
             Contains("2 columns, this row has 3"));
}

TEST_CASE("a table that was not closed keeps its rows under the name of a part", "[io][csv]") {
  Scratch const scratch;
  {
    Csv csv(scratch / "force.csv", {{"force", "N"}});
    csv.row({2.5});
  }
  CHECK_FALSE(std::filesystem::exists(scratch / "force.csv"));
  CHECK(read_file(scratch / "force.csv.part") == "force [N]\n2.5\n");
}
