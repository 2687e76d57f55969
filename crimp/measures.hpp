// What is read off the crimped device.
#pragma once

#include "simulation.hpp"

namespace valsalva::crimp {

/// The largest over nodes of frame (outer face) and tissue (compressed half thickness), twice.
double outer_diameter_mm(const Simulation& s, double thickness_fraction);
/// Axial and bending strain at the worst corner of any beam.
double max_strut_strain(const Simulation& s);

struct TissueStretch {
  double largest = 1;        ///< principal stretch
  double smallest_area = 1;  ///< deformed over reference area
  long inverted = 0;         ///< triangles below a hundredth of their area, or not finite
};
TissueStretch tissue_stretch(const Simulation& s, const std::string& body);

/// Where the bundle's cross-section goes, at the height where struts and tissue fill it most.
struct AreaBudget {
  double z_mm = 0;
  double inside_mm2 = 0;  ///< of the crimper
  double struts_mm2 = 0, tissue_full_mm2 = 0, tissue_compressed_mm2 = 0;
};
/// From the sections that horizontal planes cut through beams and triangles, `spacing_mm` apart.
AreaBudget area_budget(const Simulation& s, double thickness_fraction, double spacing_mm = 0.5);

/// Triangles of tissue through which an edge of the mesh passes.
long crossings(const Simulation& s);
/// Whole bundle; and between the frame and tissue only.
double penetration_mm(const Simulation& s);
double strut_penetration_mm(const Simulation& s);

}  // namespace valsalva::crimp
