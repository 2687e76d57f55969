// The three native leaflets as one shell mesh: nodes, attachment, thickness and fibres.
//
// Thickness: t = t_belly + (t_nodule - t_belly) exp(-(r / r_nodule)^2) + (t_rim - t_belly) exp(-(s /
// w_rim)^2), r the distance from the middle of the free edge, s the distance from the attachment. 0.4 mm and
// 0.92 mm are of Brown et al. 2022; the rim and both widths are assumed.
#pragma once

#include <array>
#include <vector>

#include "fibres.hpp"
#include "leaflet_shape.hpp"

namespace valsalva::mesher {

struct ThicknessMap {
  double belly_mm = 0.4;
  double nodule_mm = 0.92;
  double nodule_radius_mm = 2.0;
  double rim_mm = 0.6;
  double rim_width_mm = 1.5;
};

struct NativeValve {
  geometry::TriMesh mesh;            ///< normals towards the aorta
  std::vector<int> leaflet;          ///< a triangle: 0, 1, 2
  std::vector<int> attached;         ///< a node: 1 on the wall
  std::vector<double> thickness_mm;  ///< a node
  FibreField fibres;
  std::array<LeafletSizes, 3> sizes;
  std::array<double, 3> free_edge_mm;   ///< measured on the mesh
  std::array<double, 3> length_mm;      ///< nadir to mid free edge
  std::array<double, 3> mid_radius_mm;  ///< distance of the middle of the free edge from the axis
  std::array<double, 3> gauss_curvature_sr;
  double least_clearance_mm = 0;   ///< of nodes further than 2 mm from the attachment, to the wall
  double attachment_error_mm = 0;  ///< largest |phi - inset| of attached nodes
};

/// commissure_angles: three, in any order. edge_mm: mean edge length.
NativeValve fit_native_valve(const Root& root, const LeafletProportions& proportions,
                             const ThicknessMap& thickness, std::array<double, 3> commissure_angles,
                             double edge_mm, double fibre_angle_deg, const geometry::GridSdf& lumen);

}  // namespace valsalva::mesher
