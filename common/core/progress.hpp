// Progress of long work: a bar with the time left on a terminal, plain lines otherwise.
#pragma once

#include <chrono>
#include <string>

namespace valsalva {

class Progress {
 public:
  /// total: the amount of work in the caller's own measure (steps, simulated seconds, slices).
  Progress(std::string label, double total, bool speaks);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// done: work done so far, of `total`. note: a few words on the present state. Cheap enough for every step.
  void update(double done, const std::string& note = {});
  /// For a resumed run: work that was done before this process began, so that the estimate stays honest.
  void start_at(double done) { started_at_ = done; }

 private:
  void draw(double done, const std::string& note, double elapsed_s);

  using Clock = std::chrono::steady_clock;
  std::string label_;
  double total_;
  double started_at_ = 0;
  bool speaks_;
  bool terminal_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace valsalva
