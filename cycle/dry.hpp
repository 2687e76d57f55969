// A scene without fluid: bodies, supports, loads, contact (docs/scenes.md), advanced by the solver of
// [dynamics]. No parent state; every rank repeats the same work.
#pragma once

#include "core/stage.hpp"

namespace valsalva::cycle {

/// No [fluid], but bodies. InputError when the scene has both.
bool is_dry(const Case& scene);

void run_dry(StageContext& context);
void check_dry(const Case& scene);
Estimate estimate_dry(const Case& scene);

}  // namespace valsalva::cycle
