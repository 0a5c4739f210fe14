// A folder for the files of one test, gone afterwards.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

struct Scratch {
  std::filesystem::path folder;

  Scratch() {
    std::string name =
        (std::filesystem::temp_directory_path() / ("mpmpbd-" + std::string(6, 'X'))).string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("cannot make a folder like " + name);
    folder = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  Scratch(Scratch const&) = delete;
  Scratch& operator=(Scratch const&) = delete;

  std::filesystem::path operator/(std::string const& name) const { return folder / name; }

  std::size_t files() const {
    std::size_t count = 0;
    for ([[maybe_unused]] auto const& entry : std::filesystem::directory_iterator(folder)) ++count;
    return count;
  }
};

// What a call complains about, or nothing.
template <class Error, class Call> std::string complaint(Call&& call) {
  try {
    call();
  } catch (Error const& error) { return error.what(); }
  return "";
}
