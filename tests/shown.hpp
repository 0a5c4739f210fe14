// Documents show code that is compiled and run: what a page shows and its source does not hold.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <mpmpbd/io/file.hpp>

// The C++ blocks of `page` (below docs/) that do not stand in `source` (__FILE__); blanks and line
// breaks do not count. A page without a block counts as a block that is missing.
inline std::vector<std::string> blocks_not_in(std::string const& source, std::string const& page) {
  auto const without_blanks = [](std::string const& text) {
    std::string kept;
    for (char const c : text)
      if (c != ' ' && c != '\n') kept += c;
    return kept;
  };
  auto const root = std::filesystem::path(source).parent_path().parent_path().parent_path();
  auto const code = without_blanks(mpmpbd::io::read_file(source));
  auto const text = mpmpbd::io::read_file(root / "docs" / page);
  std::string const open = "```cpp\n", shut = "```";
  std::vector<std::string> missing;
  auto at = text.find(open);
  if (at == std::string::npos) missing.push_back("no block of C++ in " + page);
  while (at != std::string::npos) {
    at += open.size();
    auto const end = text.find(shut, at);
    auto const block = text.substr(at, end - at);
    if (code.find(without_blanks(block)) == std::string::npos) missing.push_back(block);
    at = text.find(open, end);
  }
  return missing;
}
