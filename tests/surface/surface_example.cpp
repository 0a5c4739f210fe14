// The code that docs/concepts/surface.md shows.
#include "catch.hpp"
#include "shown.hpp"

#include <mpmpbd/surface/marker.hpp>
#include <mpmpbd/surface/sheet_mesh.hpp>

using namespace mpmpbd;

TEST_CASE("the example of the page on the surface", "[surface][example]") {
  // A block of 40 x 20 x 20 mm, a vertex every 2 mm; refused when it is not a closed sheet.
  auto const mesh = box_sheet(Box<double>{vec(0.006, 0.006, 0.004), vec(0.046, 0.026, 0.024)},
                              Vec3<int>{{20, 10, 10}});
  check_sheet(mesh);
  auto const sheet = sheet_of(mesh);

  // Columns of one cell over a domain of 26 x 16 cells; rebuilt when vertices have moved by 0.5 mm.
  struct Lists {
    std::vector<std::int64_t>* numbers;
    std::int64_t operator()(std::int64_t i) const {
      return (*numbers)[static_cast<std::size_t>(i)];
    }
    void set(std::int64_t i, std::int64_t v) const { (*numbers)[static_cast<std::size_t>(i)] = v; }
  };
  std::vector<std::int64_t> first(26 * 16 + 1), item(16000);
  auto const columns =
      make_columns(Vec<double, 2>{}, 0.002, 26, 16, 0.0005, Lists{&first}, Lists{&item}, 16000);
  std::uint32_t const faults = columns.build(sheet);

  auto const x = vec(0.0203, 0.0161, 0.0235);
  auto const near = nearest_on_sheet(sheet, columns, x, 0.002);  // distance -0.5 mm, normal +z
  auto const path = crossings(sheet, columns, vec(0.0203, 0.0161, 0.0250),
                              x);  // one, entering, at 2/3 of the way
  auto const marker =
      mark_at(sheet, vec(0.020, 0.016, 0.024));  // stays on its triangle wherever the tissue goes

  REQUIRE(faults == 0);
  REQUIRE(near.distance == Approx(-0.0005));
  REQUIRE(norm(near.normal - vec(0.0, 0.0, 1.0)) < 1e-12);
  REQUIRE(path.count == 1);
  REQUIRE(path.list[0].share == Approx(2.0 / 3.0));
  REQUIRE(norm(position(sheet, marker) - vec(0.020, 0.016, 0.024)) < 1e-15);
}

TEST_CASE("the page shows this code", "[surface][example]") {
  CHECK(blocks_not_in(__FILE__, "concepts/surface.md") == std::vector<std::string>{});
}
