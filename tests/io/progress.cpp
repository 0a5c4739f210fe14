#include <algorithm>

#include <mpmpbd/io/progress.hpp>

#include "../catch.hpp"

using Catch::Matchers::Contains;
using mpmpbd::io::Progress;

namespace {

double now = 0.0;
double fake_clock() { return now; }

std::string content(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int c = 0; (c = std::fgetc(file)) != EOF;) text += char(c);
  return text;
}

}  // namespace

TEST_CASE("in a file a progress bar leaves one line for every tenth of the way", "[io][progress]") {
  std::FILE* const file = std::tmpfile();
  now = 100.0;
  Progress progress(2500, "stitch", "steps", file, fake_clock);
  for (int step = 1; step <= 2500; ++step) {
    now += 0.004;
    progress.update(step);
  }
  std::string const text = content(file);
  std::fclose(file);
  CHECK(std::count(text.begin(), text.end(), '\n') == 10);
  CHECK(text.find('\r') == std::string::npos);
  CHECK_THAT(
      text,
      Contains("stitch [############------------]  50 %  1250/2500 steps  250 steps/s  5 s left"));
  CHECK_THAT(text, Contains("100 %  2500/2500 steps  250 steps/s  done in 10 s"));
}

TEST_CASE("the time left is what the rate so far says", "[io][progress]") {
  now = 0.0;
  Progress const progress(1000, "", "steps", stderr, fake_clock);
  CHECK_THAT(progress.line(100, 30.0), Contains("3.33 steps/s  4 min 30 s left"));
  CHECK_THAT(progress.line(1, 30.0), Contains("8 h 19 min left"));
  CHECK_THAT(progress.line(0, 0.0), !Contains("left"));
}

TEST_CASE("big jumps and empty tasks do not break the bar", "[io][progress]") {
  std::FILE* const file = std::tmpfile();
  now = 0.0;
  Progress nothing(0, "empty", "steps", file, fake_clock);
  nothing.update(0);
  Progress jump(7, "jump", "steps", file, fake_clock);
  now = 1.0;
  jump.update(7);
  jump.update(7);
  std::string const text = content(file);
  std::fclose(file);
  CHECK(std::count(text.begin(), text.end(), '\n') == 1);
}
