// PLY files, binary little endian: point clouds and triangle meshes.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <mpmpbd/io/data_array.hpp>
#include <mpmpbd/io/file.hpp>
#include <mpmpbd/io/printable.hpp>

namespace mpmpbd::io {

namespace detail {

// The names that other programs know: x y z, nx ny nz, red green blue; otherwise name_0 name_1 ...
inline std::string ply_name(DataArray const& array, int component) {
  static constexpr std::string_view axes[] = {"x", "y", "z"};
  static constexpr std::string_view colours[] = {"red", "green", "blue"};
  if (array.components == 1) return array.name;
  if (array.components == 3 && array.name == "points") return std::string(axes[component]);
  if (array.components == 3 && array.name == "normal") return "n" + std::string(axes[component]);
  if (array.components == 3 && array.name == "colour") return std::string(colours[component]);
  return fmt::format("{}_{}", array.name, component);
}

inline std::string ply_header(Path const& path, std::span<DataArray const> columns,
                              std::size_t triangles) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment mpmpbd, lengths in metres\n";
  header += fmt::format("element vertex {}\n", columns.front().rows);
  for (DataArray const& column : columns) {
    if (column.rows != columns.front().rows)
      throw FileError(fmt::format(
          "cannot write '{}': column '{}' has {} rows, there are {} points; give one row per point",
          path.string(), column.name, column.rows, columns.front().rows));
    if (info(column.type).ply.empty())
      throw FileError(fmt::format(
          "cannot write '{}': column '{}' is of type {}; PLY has uint8, int32, float and double",
          path.string(), column.name, info(column.type).vtk));
    if (column.name.find_first_of(" \t\n") != std::string::npos)
      throw FileError(
          fmt::format("cannot write '{}': PLY allows no blank in the name of column '{}'",
                      path.string(), column.name));
    for (int c = 0; c < column.components; ++c)
      header += fmt::format("property {} {}\n", info(column.type).ply, ply_name(column, c));
  }
  if (triangles > 0)
    header += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", triangles);
  return header + "end_header\n";
}

}  // namespace detail

// Points [m], (point, 3), with further columns of one row per point, and triangles, (triangle, 3).
template <class T>
void write_ply(Path const& path, std::span<Vec3<T> const> points,
               std::span<DataArray const> point_data = {},
               std::span<Vec3<int> const> triangles = {}) {
  std::vector<DataArray> columns{data_array("points", points)};
  columns.insert(columns.end(), point_data.begin(), point_data.end());
  std::string content = detail::ply_header(path, columns, triangles.size());
  for (std::size_t row = 0; row < points.size(); ++row)
    for (DataArray const& column : columns)
      content.append(reinterpret_cast<char const*>(column.data) + row * column.row_bytes(),
                     column.row_bytes());
  for (Vec3<int> const& t : triangles) {
    content += char(3);
    content.append(reinterpret_cast<char const*>(t.m), sizeof t.m);
  }
  write_file(path, content);
}

// What a PLY file holds.
struct Ply {
  struct Column {
    std::string name;
    NumberType type;
    std::vector<double> values;  // a double holds every type of the file exactly
  };
  std::vector<Column> columns{};       // of the vertices
  std::vector<Vec3<int>> triangles{};  // (triangle, 3)

  std::vector<double> const& operator[](std::string_view name) const {
    std::string known;
    for (Column const& column : columns) {
      if (column.name == name) return column.values;
      known += " " + column.name;
    }
    throw FileError(fmt::format("this PLY file has no column '{}'; it has:{}", name, known));
  }
};

namespace detail {

// Reads a PLY file from its bytes; every complaint names the path.
class PlyReader {
 public:
  PlyReader(Path const& path, std::string const& bytes) : path_(path), bytes_(bytes) {}

  Ply read() {
    header();
    for (std::size_t row = 0; row < vertices_; ++row)
      for (Ply::Column& column : ply_.columns) column.values.push_back(number(column.type));
    for (std::size_t face = 0; face < faces_; ++face) triangle(face);
    if (at_ != bytes_.size())
      refuse(fmt::format("{} bytes follow after the last element", bytes_.size() - at_));
    return std::move(ply_);
  }

 private:
  [[noreturn]] void refuse(std::string const& reason) const {
    throw FileError(fmt::format("cannot read '{}': {}", path_.string(), printable(reason)));
  }

  std::string line() {
    std::size_t const end = bytes_.find('\n', at_);
    if (end == std::string::npos)
      refuse("the header has no end; the file is truncated or not a PLY file");
    std::string text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }

  static std::vector<std::string> words(std::string const& text) {
    std::vector<std::string> found;
    std::size_t at = 0;
    while ((at = text.find_first_not_of(' ', at)) != std::string::npos) {
      std::size_t const end = std::min(text.find(' ', at), text.size());
      found.push_back(text.substr(at, end - at));
      at = end;
    }
    return found;
  }

  std::size_t count(std::string const& text) const {
    std::size_t value = 0;
    if (text.empty() || text.size() > 18)
      refuse(fmt::format("'{}' is not a number of elements", text));
    for (char c : text) {
      if (c < '0' || c > '9') refuse(fmt::format("'{}' is not a number of elements", text));
      value = 10 * value + std::size_t(c - '0');
    }
    return value;
  }

  NumberType type(std::string const& name) const {
    for (NumberTypeInfo const& known : number_types)
      if (name == known.ply && !name.empty()) return known.type;
    if (name == "float32") return NumberType::float32;
    if (name == "float64") return NumberType::float64;
    if (name == "int32") return NumberType::int32;
    if (name == "uint8") return NumberType::uint8;
    refuse(fmt::format("numbers of type '{}'; uchar, int, float and double can be read", name));
  }

  void header() {
    if (bytes_.substr(0, 4) != "ply\n" && bytes_.substr(0, 5) != "ply\r\n")
      refuse("not a PLY file");
    line();
    std::string element;
    bool has_corners = false;
    for (std::string text = line(); text != "end_header"; text = line()) {
      std::vector<std::string> const w = words(text);
      if (w.empty() || w[0] == "comment" || w[0] == "obj_info") continue;
      if (w[0] == "format" && w.size() == 3 && w[1] == "binary_little_endian") continue;
      if (w[0] == "format")
        refuse(fmt::format("'{}'; only binary_little_endian can be read", text));
      bool const opens = w[0] == "element" && w.size() == 3;
      if (opens && w[1] == "vertex" && element.empty()) {
        vertices_ = count(w[2]);
        element = w[1];
      } else if (opens && w[1] == "face" && element != "face") {
        faces_ = count(w[2]);
        element = w[1];
      } else if (w[0] == "property" && element == "vertex" && w.size() == 3) {
        ply_.columns.push_back({w[2], type(w[1]), {}});
      } else if (text.starts_with("property list uchar int ") && element == "face" &&
                 !has_corners) {
        has_corners = true;
      } else {
        refuse(fmt::format(
            "'{}'; vertices with single properties, then faces with one 'list uchar int' can be read",
            text));
      }
    }
    if (vertices_ > 0 && ply_.columns.empty()) refuse("its vertices have no properties");
    if (faces_ > 0 && !has_corners) refuse("its faces have no corners");
  }

  template <class T> T value() {
    if (bytes_.size() - at_ < sizeof(T))
      refuse(fmt::format("the file ends after {} bytes, in the middle of its data; it is truncated",
                         bytes_.size()));
    T v;
    std::memcpy(&v, bytes_.data() + at_, sizeof v);
    at_ += sizeof v;
    return v;
  }

  double number(NumberType kind) {
    switch (kind) {
      case NumberType::uint8:
        return value<std::uint8_t>();
      case NumberType::int32:
        return value<std::int32_t>();
      case NumberType::float32:
        return double(value<float>());
      default:
        return value<double>();
    }
  }

  void triangle(std::size_t face) {
    int const corners = value<std::uint8_t>();
    if (corners != 3)
      refuse(fmt::format("face {} has {} corners; only triangles can be read", face, corners));
    Vec3<int> t;
    for (int k = 0; k < 3; ++k) {
      t[k] = value<std::int32_t>();
      if (t[k] < 0 || std::size_t(t[k]) >= vertices_)
        refuse(fmt::format("face {} names vertex {}, there are {}", face, t[k], vertices_));
    }
    ply_.triangles.push_back(t);
  }

  Path const& path_;
  std::string const& bytes_;
  std::size_t at_ = 0;
  std::size_t vertices_ = 0;
  std::size_t faces_ = 0;
  Ply ply_{};
};

}  // namespace detail

inline Ply read_ply(Path const& path) {
  std::string const bytes = read_file(path);
  return detail::PlyReader(path, bytes).read();
}

}  // namespace mpmpbd::io
