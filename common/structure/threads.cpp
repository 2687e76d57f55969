#include "structure/threads.hpp"

#include <unistd.h>

#include <cstdlib>

namespace valsalva::structure {

void wait_passively(char** argv) {
  if (std::getenv("OMP_WAIT_POLICY")) return;
  setenv("OMP_WAIT_POLICY", "passive", 1);
  execv("/proc/self/exe", argv);
}

}  // namespace valsalva::structure
