#include <mpmpbd/io/vtk.hpp>

#include "../catch.hpp"
#include "scratch.hpp"

using namespace mpmpbd::io;
using Catch::Matchers::Contains;
using mpmpbd::Vec3;

namespace {

std::vector<Vec3<float>> const points = {
    {{0.1f, -2.5f, 3.25f}}, {{7.5f, 0.3f, 900.0f}}, {{-1.0f, 4.0f, 0.02f}}};

std::string decoded(std::string const& text) {
  std::string const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned group = 0;
  int bits = 0;
  for (char c : text) {
    if (c == '=') break;
    group = (group << 6 | unsigned(digits.find(c))) & 0xffffffu;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes += char(group >> bits & 0xffu);
    }
  }
  return bytes;
}

// The numbers of the named array, after the length in front of them was checked.
template <class T> std::vector<T> array(std::string const& xml, std::string const& name) {
  std::size_t const tag = xml.find("Name=\"" + name + "\"");
  REQUIRE(tag != std::string::npos);
  std::size_t const begin = xml.find('>', tag) + 1;
  std::string const bytes = decoded(xml.substr(begin, xml.find('<', begin) - begin));
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  REQUIRE(length == bytes.size() - sizeof length);
  std::vector<T> values(length / sizeof(T));
  std::memcpy(values.data(), bytes.data() + sizeof length, length);
  return values;
}

}  // namespace

TEST_CASE("base64 of every length decodes to the same bytes", "[io][vtk]") {
  std::string bytes;
  for (int length = 0; length < 20; ++length) {
    std::string text;
    detail::append_base64(text, bytes);
    CHECK(text.size() % 4 == 0);
    CHECK(decoded(text) == bytes);
    bytes += char(37 * length + 201);
  }
}

TEST_CASE("a surface keeps points, triangles and point data", "[io][vtk]") {
  Scratch const scratch;
  std::vector<double> const stress = {1.0 / 3.0, -250000.0, 1e-9};
  DataArray const data[] = {data_array("stress [Pa]", stress), data_array("normal", points)};
  std::vector<Vec3<int>> const triangles = {{{0, 2, 1}}};
  write_vtp_surface<float>(scratch / "sheet.vtp", points, triangles, data);
  std::string const xml = read_file(scratch / "sheet.vtp");
  CHECK(array<double>(xml, "stress [Pa]") == stress);
  CHECK(array<float>(xml, "points") ==
        std::vector<float>{0.1f, -2.5f, 3.25f, 7.5f, 0.3f, 900.0f, -1.0f, 4.0f, 0.02f});
  CHECK(array<std::int64_t>(xml, "connectivity") == std::vector<std::int64_t>{0, 2, 1});
  CHECK(array<std::int64_t>(xml, "offsets") == std::vector<std::int64_t>{3});
  CHECK_THAT(xml, Contains("NumberOfPolys=\"1\""));
}

TEST_CASE("a line is one cell and particles are one cell each", "[io][vtk]") {
  Scratch const scratch;
  write_vtp_line<float>(scratch / "thread.vtp", points);
  write_vtp_points<float>(scratch / "particles.vtp", points);
  CHECK(array<std::int64_t>(read_file(scratch / "thread.vtp"), "offsets") ==
        std::vector<std::int64_t>{3});
  CHECK(array<std::int64_t>(read_file(scratch / "particles.vtp"), "offsets") ==
        std::vector<std::int64_t>{1, 2, 3});
}

TEST_CASE("point data of the wrong length is refused by name", "[io][vtk]") {
  Scratch const scratch;
  std::vector<float> const two = {1.0f, 2.0f};
  DataArray const data[] = {data_array("tension", two)};
  std::string const said =
      complaint<FileError>([&] { write_vtp_line<float>(scratch / "t.vtp", points, data); });
  CHECK_THAT(said, Contains("'tension' has 2 rows, there are 3 points"));
  CHECK(scratch.files() == 0);
}

TEST_CASE("a time series names its files relative to its own folder", "[io][vtk]") {
  Scratch const scratch;
  TimeSeries series(scratch / "run.pvd");
  std::filesystem::create_directory(scratch / "frames");
  series.add(0.0, scratch / "frames/a<b>_0.vtp");
  series.add(0.1, scratch / "frames/thread_0.vtp", 1);
  std::string const xml = read_file(scratch / "run.pvd");
  CHECK_THAT(xml, Contains(R"(timestep="0" part="0" file="frames/a&lt;b&gt;_0.vtp")"));
  CHECK_THAT(xml, Contains(R"(timestep="0.1" part="1" file="frames/thread_0.vtp")"));
}
