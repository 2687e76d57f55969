// How the threads of this program share work and wait for each other.
//
// OpenMP's threads spin while they wait, which on a machine with other work takes 80 % of the processor time
// of explicit dynamics (measured with two other programs on two cores: 5 ms instead of 0.4 ms a step). The
// runtime reads OMP_WAIT_POLICY before main begins, so the only way for a program to ask for sleeping threads
// is to start itself again with the variable set.
#pragma once

#include <string>

#include "core/errors.hpp"

namespace valsalva::structure {

/// First thing in main: unless the user has chosen a policy, starts the program again with
/// OMP_WAIT_POLICY=passive. Returns when that is already so, or when the system refuses.
void wait_passively(char** argv);

/// Runs work(i) for i = 0 ... count - 1 on the threads. Of the failures that of the lowest index is thrown,
/// as "what first + i: message" unless `what` is empty, whatever the number of threads.
template <class Work>
void for_all(int count, const char* what, int first, const Work& work) {
  int failed = count;
  std::string message;
#pragma omp parallel for schedule(static) if (count > 30)
  for (int i = 0; i < count; ++i) {
    try {
      work(i);
    } catch (const NumericalFailure& failure) {
#pragma omp critical
      if (i < failed) {
        failed = i;
        message = failure.what();
      }
    }
  }
  if (failed == count) return;
  if (*what == 0) throw NumericalFailure("{}", message);
  throw NumericalFailure("{} {}: {}", what, first + failed, message);
}

}  // namespace valsalva::structure
