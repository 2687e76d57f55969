// Progress of long work: a bar with the time left on a terminal that a person looks at, plain lines
// otherwise.
//
// Under mpirun a program sees a terminal of mpirun's own, wherever mpirun's output goes: plain lines there,
// and on terminals that cannot redraw a line (TERM=dumb). The environment variable VALSALVA_PROGRESS = bar or
// lines decides otherwise.
#pragma once

#include <chrono>
#include <string>

namespace valsalva {

/// What decides between bar and lines; texts may be null (not set).
struct ProgressSurroundings {
  bool terminal = false;           ///< stdout is one
  const char* mpi_size = nullptr;  ///< OMPI_COMM_WORLD_SIZE
  const char* kind = nullptr;      ///< TERM
  const char* wish = nullptr;      ///< VALSALVA_PROGRESS
};

/// InputError when the wish is neither bar nor lines.
bool draws_bar(const ProgressSurroundings& surroundings);

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
  bool bar_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace valsalva
