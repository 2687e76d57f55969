// Studies that have a file of their own; the others are in study.cpp.
#pragma once

#include <string>

namespace valsalva {

/// Grid spacing in mm, time until which the valve closes.
int study_diastole(double h, double end_s);

/// Kernel, repulsion and standoff: what keeps closed leaflets apart. Same arguments.
int study_separation(double h, double end_s);

/// End in s.
int study_bar(int cells_across, const std::string& kernel, double end_s);

}  // namespace valsalva
