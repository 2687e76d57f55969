// Where a run is worst: what an alarm's message says beside its reason, so that there is a place to look at.
#pragma once

#include <string>

#include "coupling/immersed_shell.hpp"
#include "fluid/flow.hpp"

namespace valsalva::cycle {

/// "the fluid is fastest at (x, y, z) mm, ... mm/s, the leaflets longest at node ..."; what is not finite
/// comes first. Components on their faces count. shell may be null (collective; the same on all ranks).
std::string worst_place(const fluid::Flow& flow, const coupling::ImmersedShell* shell);

}  // namespace valsalva::cycle
