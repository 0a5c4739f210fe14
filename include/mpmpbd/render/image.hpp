// A picture in memory: colours, and how far away what they show is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mpmpbd::render {

struct Image {
  int width = 0;                    // [pixel]
  int height = 0;                   // [pixel]
  std::vector<std::uint8_t> rgb{};  // sRGB, (height, width, 3), top row first
  std::vector<float>
      depth{};  // along the line of sight [m], (height, width); infinite where nothing is

  Image() = default;
  Image(int columns, int rows) { resize(columns, rows); }

  void resize(int columns, int rows) {
    width = columns;
    height = rows;
    rgb.resize(3 * pixels());
    depth.resize(pixels());
  }
  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  std::size_t pixel(int column, int row) const {
    return std::size_t(row) * std::size_t(width) + std::size_t(column);
  }
};

}  // namespace mpmpbd::render
