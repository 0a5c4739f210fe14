// The result of one law of a law suite: what was measured, and what is allowed.
//
// Suites return plain lists, so that they serve any test framework:
//   for (auto const& law : material_laws<MyMaterial, double>(k)) { INFO(law.text()); CHECK(law.holds()); }
#pragma once

#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace mpmpbd {

struct Law {
  std::string name;
  double error = 0.0;  // the worst found; what it is relative to is said in the name
  double limit = 0.0;

  // NaN does not hold.
  bool holds() const { return error <= limit; }
  std::string text() const {
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "%.3g, allowed %.3g", error, limit);
    return name + ": " + numbers;
  }
};
using Laws = std::vector<Law>;

// The law of a suite whose name begins with `name`; error NaN when there is none.
inline Law find_law(Laws const& laws, std::string const& name) {
  for (auto const& law : laws)
    if (law.name.compare(0, name.size(), name) == 0) return law;
  return {"no law named " + name, std::numeric_limits<double>::quiet_NaN(), 0.0};
}

}  // namespace mpmpbd
