// Where the presets of the scenes are.
#pragma once

#include <filesystem>

namespace test {

inline std::filesystem::path scenes() {
  return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path() / "examples" /
         "scenes";
}

}  // namespace test
