// Benchmark flows with published results. Each is set up, run to its end and measured by one function.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fluid/flow.hpp"

namespace valsalva::fluid {

/// Columns of numbers of a file in the reference folder, after lines that do not begin with a number; nothing
/// when the folder is absent. An empty field is not a number.
std::optional<std::vector<std::vector<double>>> reference(const std::string& file);

/// Unit square under a lid of unit speed, n x n x 3 cells, periodic in the third direction; to time `end`.
struct Cavity {
  double rms_u, rms_v;  ///< of the differences from Ghia et al. (1982) on the two middle lines; -1: no data
  double least_u, least_v, most_v;  ///< on the middle lines, at faces
  double change;                    ///< largest change of u over the last time unit
};
Cavity cavity(double reynolds, int n, double end, Convection convection);

/// Schaefer and Turek (1996), case 2D-1: cylinder of diameter 0.1 at (0.2, 0.2) in a channel 0.41 x 2.2, Re
/// 20; n cells across the channel.
struct Cylinder {
  double drag, lift, pressure_difference;
  double change;  ///< relative change of the drag over the last second
};
Cylinder cylinder(int n, double end, Wall wall);

/// Sphere of unit diameter in a box of `width` squared and twice that long, uniform inflow; drag coefficient.
struct Sphere {
  double drag, change;
};
Sphere sphere(double reynolds, double cells_per_diameter, double width, double end, Wall wall);

/// Taylor-Green vortex at Re 1600 in the periodic box of side 2 pi.
struct Dissipation {
  std::vector<double> time, rate, energy;  ///< -dE/dt of the mean kinetic energy
  double peak, peak_time, rms;  ///< rms: difference from Wang et al. (2013) over its mean; -1: no data
};
Dissipation taylor_green(int n, double end, const FlowParameters& scheme);

}  // namespace valsalva::fluid
