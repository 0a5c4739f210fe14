// Results of a run as JSON, through nlohmann-json where it is present.
#pragma once

#include <mpmpbd/io/file.hpp>

#if __has_include(<nlohmann/json.hpp>)
#include <cmath>
#include <nlohmann/json.hpp>

namespace mpmpbd::io {

using Json = nlohmann::ordered_json;  // keeps the order in which a program tells its results

// A number with its unit: {"value": 1.2, "unit": "N"}.
inline Json quantity(double value, std::string_view unit) {
  return {{"value", value}, {"unit", unit}};
}

namespace detail {
// JSON has no NaN and no infinity, and the library writes null for both: here they stay visible.
inline void name_what_is_not_finite(Json& json) {
  if (json.is_structured()) {
    for (Json& item : json) name_what_is_not_finite(item);
  } else if (json.is_number_float() && !std::isfinite(json.get<double>())) {
    double const value = json.get<double>();
    json = std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
  }
}
}  // namespace detail

inline void write_json(Path const& path, Json json) {
  detail::name_what_is_not_finite(json);
  write_file(path, json.dump(2) + "\n");
}

inline Json read_json(Path const& path) {
  std::string const text = read_file(path);
  try {
    return Json::parse(text);
  } catch (Json::exception const& error) {  // not only of its grammar: 1e999 is out of range
    throw FileError(
        fmt::format("cannot read '{}': not a JSON file ({})", path.string(), error.what()));
  }
}

}  // namespace mpmpbd::io
#endif
