// A scene of fluid in a box, without a parent state (docs/flow-scenes.md).
#pragma once

#include "core/stage.hpp"

namespace valsalva::cycle {

/// [fluid] with a box_mm.
bool is_flow_scene(const Case& scene);

void run_flow_scene(StageContext& context);
void check_flow_scene(const Case& scene);
Estimate estimate_flow_scene(const Case& scene, int ranks);

}  // namespace valsalva::cycle
