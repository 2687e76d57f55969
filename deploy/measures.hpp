// What is reported of a deployment.
//
//   implant_depth_mm               minus the mean height of the skirt's lower edge (of the inflow without
//   skirt) expanded_diameter_annulus_mm   perimeter over pi of the frame's section at the annulus plane z =
//   0, outside eccentricity                   1 - smallest / largest width of that section
//   apposition_gap_area_mm2        area of skirt whose outside, a strut's depth further out, is further than
//                                  `apposition_gap` from wall and native leaflets
//   contact_area_mm2               area of struts and skirt that touch wall or native leaflets
//   chronic_outward_force_N        radial components of the contact forces on the device, summed
//   max_penetration_mm             largest overlap with the wall
//   max_wall_stress_kPa            Laplace estimate, the largest over bands of 2 mm height: hoop stress
//                                  F_r / (2 pi h t) with F_r the radial contact force in the band, h its
//                                  height, t the wall's thickness; no local bending, no stress concentration
//                                  under a strut
#pragma once

#include "simulation.hpp"

namespace valsalva::deploy {

struct Measures {
  double implant_depth_mm = 0;
  double expanded_diameter_annulus_mm = 0;
  double eccentricity = 0;
  double apposition_gap_area_mm2 = 0;
  double contact_area_mm2 = 0;
  double chronic_outward_force_N = 0;
  double max_penetration_mm = 0;
  double max_wall_stress_kPa = 0;
  long strut_crossings = 0;  ///< edges that pass through a face of another body or of their own
  double max_frame_strain = 0;
  double max_leaflet_stretch = 1;
  double max_exponent = 0;  ///< of the tissues' law; beyond 6 the exponential is continued
  Points frame_force_uN;    ///< of wall and native leaflets, on the frame's nodes
  std::vector<double> friction_capacity_uN;
};

Measures measure(const Simulation& s, const Inputs& in, const Parameters& p);

/// For the history, cheap: mean depth of the skirt's edge and mean diameter of the frame's inflow, mm.
double depth_now(const Simulation& s, const Inputs& in);
double inflow_diameter_now(const Simulation& s, const Inputs& in);

}  // namespace valsalva::deploy
