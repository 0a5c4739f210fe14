// The covering array, scenes 0 of 4; see covering_array.py.
#include "covering_array.hpp"

#include <set>

TEST_CASE("Each pair of policies meets: free") { covering::check_rows(covering::Rows0{}); }

// The rows are what covering_array.py says they are: few enough, and all pairs are there.
TEST_CASE("The covering array has at most 24 scenes and all pairs that compose") {
  using namespace covering;
  std::set<std::string> pairs;
  int scenes = 0;
  auto const collect = [&]<class... Rows>(TypeList<Rows...>) {
    for (auto const& names : {Rows::names()...}) {
      ++scenes;
      for (std::size_t a = 0; a < names.size(); ++a)
        for (std::size_t b = a + 1; b < names.size(); ++b)
          pairs.insert(names[a] + " + " + names[b]);
    }
  };
  collect(Rows0{});
  collect(Rows1{});
  collect(Rows2{});
  collect(Rows3{});
  CHECK(scenes <= 24);
  CHECK(pairs.size() == covered_pairs);
}
