// The corpus of the fuzzers (tests/fuzz), replayed without them: what is taken and what is refused is as the names of
// the files say.
#include <algorithm>
#include <vector>

#include "catch.hpp"
#include "fuzz/entries.hpp"

namespace {

std::filesystem::path project() {
  return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
}

template <class Entry> void replay(std::string const& name, Entry const& taken) {
  int both[2] = {0, 0};
  std::vector<std::filesystem::path> files;
  for (auto const& entry :
       std::filesystem::directory_iterator(project() / "tests" / "fuzz" / "corpus" / name))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (auto const& file : files) {
    INFO(file.string());
    auto const stem = file.filename().string();
    bool const expected = stem.starts_with("taken");
    CHECK((expected || stem.starts_with("refused")));
    auto const bytes = mpmpbd::io::read_file(file);
    CHECK(taken(bytes) == expected);
    ++both[expected ? 1 : 0];
    // Cut anywhere it is refused or valid, never anything else.
    for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 40)
      CHECK_NOTHROW(taken(bytes.substr(0, length)));
  }
  CHECK(both[0] > 0);
  CHECK(both[1] > 0);
}

}  // namespace

TEST_CASE("scene files of the corpus are taken or refused", "[io][fuzz]") {
  replay("scene_file", fuzz::scene_file);
  for (auto const* scene : {"paper", "phantom", "coarse", "suturing_task"}) {
    INFO(scene);
    auto const file = project() / "examples" / "scenes" / (std::string(scene) + ".toml");
    CHECK_NOTHROW(fuzz::scene_file(mpmpbd::io::read_file(file)));
  }
}
TEST_CASE("state files of the corpus are taken or refused", "[io][fuzz]") {
  replay("state_file", fuzz::state_file);
}
TEST_CASE("surfaces of the corpus are taken or refused", "[io][fuzz]") {
  replay("surface_file", fuzz::surface_file);
}
TEST_CASE("summaries of the corpus are taken or refused", "[io][fuzz]") {
  replay("summary_file", fuzz::summary_file);
}
