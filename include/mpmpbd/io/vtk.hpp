// VTK XML files that ParaView opens: poly data (.vtp) of surfaces, lines and points, and their time
// series (.pvd).
//
// Numbers are stored inline as base64 of their bytes: exact, and still one file that text tools open.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <mpmpbd/io/data_array.hpp>
#include <mpmpbd/io/file.hpp>

namespace mpmpbd::io {

namespace detail {

inline void append_base64(std::string& out, std::string_view bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  out.reserve(out.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= bytes.size() - i ? digits[group >> (18 - 6 * k) & 63u] : '=';
  }
}

inline std::string xml_escaped(std::string_view text) {
  std::string out;
  for (char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  return out;
}

inline void append_array(std::string& xml, DataArray const& array) {
  xml += fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="binary">)",
                     info(array.type).vtk, xml_escaped(array.name), array.components);
  // The number of bytes, then the bytes, as one base64 text.
  std::uint64_t const length = array.bytes();
  std::string bytes(sizeof length + length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  if (length > 0) std::memcpy(bytes.data() + sizeof length, array.data, length);
  append_base64(xml, bytes);
  xml += "</DataArray>\n";
}

// `corners` vertex numbers per cell, (cell, corners).
struct Cells {
  std::string_view kind;  // Verts, Lines or Polys
  std::vector<std::int64_t> corners;
  std::int64_t corners_per_cell;
};

inline void append_cells(std::string& xml, Cells const& cells) {
  std::vector<std::int64_t> ends;
  for (std::int64_t end = cells.corners_per_cell; end <= std::int64_t(cells.corners.size());
       end += cells.corners_per_cell)
    ends.push_back(end);
  xml += fmt::format("<{}>\n", cells.kind);
  append_array(xml, data_array("connectivity", cells.corners));
  append_array(xml, data_array("offsets", ends));
  xml += fmt::format("</{}>\n", cells.kind);
}

inline void write_vtp(Path const& path, DataArray const& points, Cells const& cells,
                      std::span<DataArray const> point_data) {
  for (DataArray const& array : point_data)
    if (array.rows != points.rows)
      throw FileError(fmt::format(
          "cannot write '{}': point data '{}' has {} rows, there are {} points; give one row per point",
          path.string(), array.name, array.rows, points.rows));
  std::size_t const count =
      cells.corners.empty() ? 0 : cells.corners.size() / std::size_t(cells.corners_per_cell);
  auto const number_of = [&](std::string_view kind) { return kind == cells.kind ? count : 0; };
  std::string xml = "<?xml version=\"1.0\"?>\n";
  xml +=
      R"(<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">)";
  xml += fmt::format(
      "\n<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
      points.rows, number_of("Verts"), number_of("Lines"), number_of("Polys"));
  xml += "<Points>\n";
  append_array(xml, points);
  xml += "</Points>\n";
  append_cells(xml, cells);
  xml += "<PointData>\n";
  for (DataArray const& array : point_data) append_array(xml, array);
  xml += "</PointData>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  write_file(path, xml);
}

}  // namespace detail

// A surface: points [m], (point, 3), and triangles, (triangle, 3).
template <class T>
void write_vtp_surface(Path const& path, std::span<Vec3<T> const> points,
                       std::span<Vec3<int> const> triangles,
                       std::span<DataArray const> point_data = {}) {
  std::vector<std::int64_t> corners;
  corners.reserve(3 * triangles.size());
  for (Vec3<int> const& t : triangles) corners.insert(corners.end(), {t[0], t[1], t[2]});
  detail::write_vtp(path, data_array("points", points), {"Polys", std::move(corners), 3},
                    point_data);
}

// A line through the points [m] in their order, (point, 3): a thread, or the arc of a needle.
template <class T>
void write_vtp_line(Path const& path, std::span<Vec3<T> const> points,
                    std::span<DataArray const> point_data = {}) {
  std::vector<std::int64_t> corners(points.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = std::int64_t(i);
  auto const count = std::int64_t(corners.size());
  detail::write_vtp(path, data_array("points", points),
                    {"Lines", std::move(corners), count > 0 ? count : 1}, point_data);
}

// Single points [m], (point, 3): particles.
template <class T>
void write_vtp_points(Path const& path, std::span<Vec3<T> const> points,
                      std::span<DataArray const> point_data = {}) {
  std::vector<std::int64_t> corners(points.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = std::int64_t(i);
  detail::write_vtp(path, data_array("points", points), {"Verts", std::move(corners), 1},
                    point_data);
}

// Which file shows which time. The file is rewritten as a whole with every entry, so ParaView can
// open a run that still goes on.
class TimeSeries {
 public:
  explicit TimeSeries(Path path) : path_(std::move(path)) {}

  // `part` tells apart several files of the same time [s], for example 0 tissue, 1 thread, 2 needle.
  void add(double time, Path const& file, int part = 0) {
    Path const folder = path_.has_parent_path() ? path_.parent_path() : Path(".");
    Path const relative = std::filesystem::relative(file, folder);
    entries_ += fmt::format("<DataSet timestep=\"{}\" part=\"{}\" file=\"{}\"/>\n", time, part,
                            detail::xml_escaped(relative.generic_string()));
    write_file(
        path_,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n" +
            entries_ + "</Collection>\n</VTKFile>\n");
  }

 private:
  Path path_;
  std::string entries_{};
};

}  // namespace mpmpbd::io
