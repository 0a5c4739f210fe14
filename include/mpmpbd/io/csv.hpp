// Time series as CSV: a header with names and units, then rows of numbers.
#pragma once

#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/ranges.h>

#include <mpmpbd/io/file.hpp>

namespace mpmpbd::io {

class Csv {
 public:
  struct Column {
    std::string name;
    std::string unit;  // SI, "1" for a pure number
  };

  // The header reads `time [s],force [N]`.
  Csv(Path path, std::vector<Column> const& columns)
      : file_(std::move(path)), width_(columns.size()) {
    std::string header;
    for (Column const& column : columns)
      header +=
          (header.empty() ? "" : ",") + quoted(fmt::format("{} [{}]", column.name, column.unit));
    file_.write(header + "\n");
  }
  // Without close() the rows stay in `<path>.part`: a run that stopped half-way can be looked at.
  ~Csv() { file_.abandon(); }
  Csv(Csv const&) = delete;
  Csv& operator=(Csv const&) = delete;

  // Numbers are written with as many digits as it takes to read back the same number.
  void row(std::span<double const> values) {
    if (values.size() != width_)
      throw std::invalid_argument(
          fmt::format("'{}' has {} columns, this row has {} numbers; give one per column",
                      file_.path().string(), width_, values.size()));
    file_.write(fmt::format("{}\n", fmt::join(values, ",")));
  }
  void row(std::initializer_list<double> values) { row(std::span(values.begin(), values.size())); }

  // Gives the file its name.
  void close() { file_.commit(); }

 private:
  static std::string quoted(std::string const& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string out = "\"";
    for (char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
  }

  OutputFile file_;
  std::size_t width_;
};

}  // namespace mpmpbd::io
