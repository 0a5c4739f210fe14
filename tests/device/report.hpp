// What a program on a GPU has found: a line for each check, and how many there were.
#pragma once

#include <cstdio>

namespace test {

struct Report {
  int passed = 0, failed = 0;
  void count(bool ok) { (ok ? passed : failed) += 1; }
  // The program's last line, and its exit status.
  int end() const {
    std::printf("%d passed, %d failed\n", passed, failed);
    return failed == 0 ? 0 : 1;
  }
};
inline Report report;

inline char const* word(bool ok) { return ok ? "pass" : "FAIL"; }
inline void check(bool ok, char const* what, double value = 0) {
  std::printf("%s: %s (%.3g)\n", word(ok), what, value);
  report.count(ok);
}
inline void check(bool ok, char const* scene, char const* what, double value = 0) {
  std::printf("%s: %s: ", word(ok), scene);
  std::printf("%s (%.3g)\n", what, value);
  report.count(ok);
}

}  // namespace test
