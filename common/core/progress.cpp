#include "core/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace valsalva {
namespace {

constexpr double seconds_between_bars = 0.2;
constexpr double seconds_between_lines = 10.0;

std::string duration(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

double seconds_between(auto from, auto to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

Progress::Progress(std::string label, double total, bool speaks)
    : label_(std::move(label)),
      total_(total),
      speaks_(speaks),
      terminal_(isatty(STDOUT_FILENO) == 1),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (drawn_ && terminal_) std::fputc('\n', stdout);
}

void Progress::update(double done, const std::string& note) {
  if (!speaks_) return;
  const auto now = Clock::now();
  if (seconds_between(last_, now) < (terminal_ ? seconds_between_bars : seconds_between_lines)) return;
  last_ = now;
  draw(done, note, seconds_between(start_, now));
}

void Progress::draw(double done, const std::string& note, double elapsed_s) {
  const double fraction = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 0.0;
  const double here = done - started_at_;
  const std::string left =
      here > 0 ? duration(elapsed_s * std::max(0.0, total_ - done) / here) + " left" : "";
  const std::string line = fmt::format("{} {:5.1f} %  {}  {}", label_, 100 * fraction, left, note);
  if (terminal_) {
    constexpr int width = 24;
    const int full = static_cast<int>(fraction * width);
    fmt::print(stdout, "\r\033[K[{}{}] {}", std::string(full, '='), std::string(width - full, ' '), line);
  } else {
    fmt::print(stdout, "{}\n", line);
  }
  std::fflush(stdout);
  drawn_ = true;
}

}  // namespace valsalva
