#include "core/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "core/errors.hpp"

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

bool draws_bar(const ProgressSurroundings& s) {
  const std::string_view wish = s.wish ? s.wish : "", kind = s.kind ? s.kind : "";
  if (wish == "bar") return true;
  if (wish == "lines") return false;
  if (!wish.empty())
    throw InputError("environment variable VALSALVA_PROGRESS is '{}'; expected bar, lines or nothing", wish);
  return s.terminal && !s.mpi_size && kind != "dumb";
}

Progress::Progress(std::string label, double total, bool speaks)
    : label_(std::move(label)),
      total_(total),
      speaks_(speaks),
      bar_(draws_bar({isatty(STDOUT_FILENO) == 1, std::getenv("OMPI_COMM_WORLD_SIZE"), std::getenv("TERM"),
                      std::getenv("VALSALVA_PROGRESS")})),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (drawn_ && bar_) std::fputc('\n', stdout);
}

void Progress::update(double done, const std::string& note) {
  if (!speaks_) return;
  const auto now = Clock::now();
  if (seconds_between(last_, now) < (bar_ ? seconds_between_bars : seconds_between_lines)) return;
  last_ = now;
  draw(done, note, seconds_between(start_, now));
}

void Progress::draw(double done, const std::string& note, double elapsed_s) {
  const double fraction = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 0.0;
  const double here = done - started_at_;
  const std::string left =
      here > 0 ? duration(elapsed_s * std::max(0.0, total_ - done) / here) + " left" : "";
  const std::string line = fmt::format("{} {:5.1f} %  {}  {}", label_, 100 * fraction, left, note);
  if (bar_) {
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
