// How the threads of this program wait for each other.
//
// OpenMP's threads spin while they wait, which on a machine with other work takes 80 % of the processor time
// of explicit dynamics (measured with two other programs on two cores: 5 ms instead of 0.4 ms a step). The
// runtime reads OMP_WAIT_POLICY before main begins, so the only way for a program to ask for sleeping threads
// is to start itself again with the variable set.
#pragma once

namespace valsalva::structure {

/// First thing in main: unless the user has chosen a policy, starts the program again with
/// OMP_WAIT_POLICY=passive. Returns when that is already so, or when the system refuses.
void wait_passively(char** argv);

}  // namespace valsalva::structure
