#include <mpmpbd/io/ply.hpp>

#include "../catch.hpp"
#include "scratch.hpp"

using namespace mpmpbd::io;
using Catch::Matchers::Contains;
using mpmpbd::Vec3;

namespace {

// Numbers without a short decimal form, away from 1.
std::vector<Vec3<double>> const points = {
    {{0.1, -2.3, 1e-7}}, {{17.0 / 3.0, 40.0, 0.02}}, {{-1.0 / 7.0, 3.3, 900.1}}};
std::vector<float> const pressure = {-714285.8f, 0.1f, 178571.4f};
std::vector<std::int32_t> const body = {0, 7, -3};
std::vector<Vec3<std::uint8_t>> const colour = {{{255, 0, 12}}, {{1, 2, 3}}, {{200, 201, 202}}};
std::vector<Vec3<int>> const triangles = {{{0, 1, 2}}, {{2, 1, 0}}};

void write(Path const& path) {
  DataArray const columns[] = {data_array("pressure", pressure), data_array("body", body),
                               data_array("colour", colour)};
  write_ply<double>(path, points, columns, triangles);
}

}  // namespace

TEST_CASE("a PLY file read back gives the same numbers", "[io][ply]") {
  Scratch const scratch;
  write(scratch / "mesh.ply");
  Ply const ply = read_ply(scratch / "mesh.ply");
  REQUIRE(ply["x"].size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(ply["x"][i] == points[i][0]);
    CHECK(ply["y"][i] == points[i][1]);
    CHECK(ply["z"][i] == points[i][2]);
    CHECK(ply["pressure"][i] == double(pressure[i]));
    CHECK(ply["body"][i] == body[i]);
    CHECK(ply["red"][i] == colour[i][0]);
    CHECK(ply["blue"][i] == colour[i][2]);
  }
  REQUIRE(ply.triangles.size() == 2);
  CHECK(ply.triangles[1] == triangles[1]);
}

TEST_CASE("points in float stay float", "[io][ply]") {
  Scratch const scratch;
  std::vector<Vec3<float>> const cloud(5, {{0.1f, 0.2f, 0.3f}});
  write_ply<float>(scratch / "cloud.ply", cloud);
  Ply const ply = read_ply(scratch / "cloud.ply");
  CHECK(ply.columns[0].type == NumberType::float32);
  CHECK(ply["z"][4] == double(0.3f));
  CHECK(ply.triangles.empty());
}

TEST_CASE("a PLY file cut at any byte is refused with its path", "[io][ply]") {
  Scratch const scratch;
  write(scratch / "mesh.ply");
  std::string const whole = read_file(scratch / "mesh.ply");
  Path const cut = scratch / "cut.ply";
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write_file(cut, std::string_view(whole).substr(0, length));
    INFO(length);
    REQUIRE_THAT(complaint<FileError>([&] { read_ply(cut); }), Contains(cut.string()));
  }
}

TEST_CASE("what is not our kind of PLY file is refused with the reason", "[io][ply]") {
  Scratch const scratch;
  Path const path = scratch / "foreign.ply";
  auto const said = [&](std::string const& content) {
    write_file(path, content);
    return complaint<FileError>([&] { read_ply(path); });
  };
  std::string const head = "ply\nformat binary_little_endian 1.0\n";
  CHECK_THAT(said("solid cube"), Contains("not a PLY file"));
  CHECK_THAT(said("ply\nformat ascii 1.0\nend_header\n"), Contains("binary_little_endian"));
  CHECK_THAT(said(head + "element vertex many\nend_header\n"), Contains("'many'"));
  CHECK_THAT(said(head + "element vertex 1\nproperty half x\nend_header\n"), Contains("half"));
  CHECK_THAT(said(head + "element vertex 0\nend_header\nmore"), Contains("4 bytes follow"));
  // Numbers that cost nothing to claim, and elements in an order in which they are not read.
  CHECK_THAT(said(head + "element vertex 999999999999999999\nend_header\n"),
             Contains("no properties"));
  CHECK_THAT(said(head + "element face 1\nend_header\n\3"), Contains("no corners"));
  std::string const corners = "property list uchar int v\n";
  CHECK_THAT(said(head + "element face 1\n" + corners + "element vertex 1\nend_header\n"),
             Contains("'element vertex 1'"));
  CHECK_THAT(said(head + "element face 1\n" + corners + corners + "end_header\n"),
             Contains("one 'list uchar int'"));
  std::string const face =
      head +
      "element vertex 1\nproperty uchar x\nelement face 1\nproperty list uchar int v\nend_header\nA";
  CHECK_THAT(said(face + '\4'), Contains("4 corners"));
  CHECK_THAT(said(face + '\3' + std::string("\0\0\0\0\0\0\0\0\1\0\0\0", 12)),
             Contains("names vertex 1"));
}

TEST_CASE("a column of the wrong length or an unknown name is refused by name", "[io][ply]") {
  Scratch const scratch;
  std::vector<float> const two = {1.5f, 2.5f};
  DataArray const columns[] = {data_array("stress", two)};
  std::string const said =
      complaint<FileError>([&] { write_ply<double>(scratch / "bad.ply", points, columns); });
  CHECK_THAT(said, Contains("'stress' has 2 rows, there are 3 points"));
  DataArray const blank[] = {data_array("stress [Pa]", points)};
  CHECK_THAT(complaint<FileError>([&] { write_ply<double>(scratch / "bad.ply", points, blank); }),
             Contains("'stress [Pa]'"));
  CHECK(scratch.files() == 0);
  write(scratch / "mesh.ply");
  CHECK_THAT(complaint<FileError>([&] { read_ply(scratch / "mesh.ply")["tension"]; }),
             Contains("it has: x y z"));
}
