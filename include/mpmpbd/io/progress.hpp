// A progress bar with rate and time left; in a pipe, one line for every tenth of the way.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace mpmpbd::io {

// Seconds on a clock that never goes back.
inline double monotonic_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class Progress {
 public:
  // `total` items of `unit`, for example 2500 "steps".
  Progress(std::int64_t total, std::string label, std::string unit = "steps",
           std::FILE* out = stderr, double (*clock)() = monotonic_seconds)
      : total_(total > 0 ? total : 1),
        label_(std::move(label)),
        unit_(std::move(unit)),
        out_(out),
        clock_(clock),
        terminal_(isatty(fileno(out)) != 0),
        started_(clock()) {}

  // `done` items so far; call it as often as is convenient.
  void update(std::int64_t done) {
    double const now = clock_();
    if (terminal_) {
      bool const last = done >= total_ && !finished_;
      if (!last && now - drawn_ < 0.1) return;
      drawn_ = now;
      fmt::print(out_, "\r{}{}\x1b[K{}", label_, line(done, now), last ? "\n" : "");
      std::fflush(out_);
      finished_ = done >= total_;
    } else if (10 * done / total_ > tenths_) {
      tenths_ = 10 * done / total_;
      fmt::print(out_, "{}{}\n", label_, line(done, now));
      std::fflush(out_);
    }
  }

  // For example ` [#####-----]  50 %  1250/2500 steps  312 steps/s  4 s left`.
  std::string line(std::int64_t done, double now) const {
    constexpr int width = 24;
    int const filled = int(std::min(done, total_) * width / total_);
    double const elapsed = now - started_;
    std::string text = fmt::format(" [{:#<{}}{:-<{}}] {:3} %  {}/{} {}", "", filled, "",
                                   width - filled, 100 * done / total_, done, total_, unit_);
    if (done <= 0 || elapsed <= 0.0) return text;
    double const rate = double(done) / elapsed;
    text += fmt::format("  {} {}/s", readable(rate), unit_);
    if (done >= total_) return text + fmt::format("  done in {}", duration(elapsed));
    return text + fmt::format("  {} left", duration(double(total_ - done) / rate));
  }

 private:
  static std::string readable(double rate) {
    return rate >= 100.0 ? fmt::format("{:.0f}", rate) : fmt::format("{:.3g}", rate);
  }
  static std::string duration(double seconds) {
    std::int64_t const s = std::llround(seconds);
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
    return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
  }

  std::int64_t total_;
  std::string label_;
  std::string unit_;
  std::FILE* out_;
  double (*clock_)();
  bool terminal_;
  double started_;
  double drawn_ = -1e30;
  std::int64_t tenths_ = 0;
  bool finished_ = false;
};

}  // namespace mpmpbd::io
