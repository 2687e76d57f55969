// A [[load]] entry: forces, moments, pressure, traction, gravity, the pressure of an enclosed volume.
#pragma once

#include "assembly/entry.hpp"
#include "assembly/scene.hpp"

namespace valsalva::assembly {

/// standard: the factor over time where the entry gives none. InputError names the entry.
void add_load(Scene& scene, const Entry& e, const TimeTable& standard);

}  // namespace valsalva::assembly
