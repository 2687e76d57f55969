// Sums over the grid that probes report. Collective; axes of the solver; cells and faces in solids left out.
#pragma once

#include <functional>

#include "fluid/flow.hpp"

namespace valsalva::flow_scene {

struct Turbulence {
  double kinetic_nJ = 0, dissipation_nJ_per_s = 0, enstrophy_mm3_per_s2 = 0;
};
Turbulence turbulence(const fluid::Flow& flow);

using Inside = std::function<bool(const Vec3&)>;

/// Flow along +axis through the plane of faces nearest to `at`, where inside(x) holds, mm3/s.
double section_flow(const fluid::Flow& flow, int axis, double at, const Inside& inside);
/// Mean pressure of the cells on both sides of that plane, Pa. InputError when there is none.
double section_pressure(const fluid::Flow& flow, int axis, double at, const Inside& inside,
                        const std::string& what);

struct Norms {
  double rms = 0, largest = 0;
};
/// exact(d, x): component d, mm/s. rms: sqrt of the sum over components of the mean squares.
Norms velocity_error(const fluid::Flow& flow, const std::function<double(int, const Vec3&)>& exact);
Norms pressure_error(const fluid::Flow& flow, const std::function<double(const Vec3&)>& exact);

}  // namespace valsalva::flow_scene
