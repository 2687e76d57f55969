// Keeps the volume of every cell of immersed solids.
//
// The fluid's velocity is free of divergence, and so bodies that move with it keep the volume of each of
// their parts. What nodes take of it (quadrature and averages over elements, or linear interpolation between
// nodes) is so only up to the truncation error, and nothing brings such a change of volume back: the body's
// volumetric stress is answered by a pressure of the fluid inside the body, without motion. It accumulates.
// In a bar two cells thick, parts above and below the middle plane came to differ in volume by three times
// the strain of bending, with the opposite deviatoric strain: the bar lost its stiffness against bending.
//
// Every step moves free nodes a part of the way back, cell by cell and all at once:
//   x_a += sum_c s (V0_c - V_c) / (n S_c) g_ca,   g_ca = P_a dV_c/dx_a,  S_c = sum_a |g_ca|^2
// with the share s = min(1, rate dt), V0 the volume at the start, P_a the projector on free directions and n
// the largest number of cells at a node: the sum over cells is then a contraction. In refinement the motion
// goes to zero with the truncation error.
//
// Limits: the motion is not adjoint to the spreading of forces, so that energy may be put in; the rate is to
// be as low as the motion allows (docs/verification/flow-bodies.md).
//
// Cells: tetrahedra (4 nodes) and hexahedra (8 nodes, Gauss 2 x 2 x 2, which is exact for their volume).
#pragma once

#include <span>
#include <vector>

#include "coupling/sampling.hpp"

namespace valsalva::coupling {

class VolumeKeeper {
 public:
  /// Of the cells those with volume count; start: where they have theirs. held: projectors on held
  /// directions, one a node, or empty.
  VolumeKeeper(std::span<const Cell> cells, const Points& start, const std::vector<Mat3>& held);

  bool empty() const { return cells_.empty(); }
  /// share: s, up to 1.
  void correct(double share, Points& x) const;
  /// The largest relative change of a cell's volume.
  double largest_change(const Points& x) const;

 private:
  double volume(const Cell& cell, const Points& x, std::array<Vec3, 8>* gradient) const;

  std::vector<Cell> cells_;
  std::vector<double> start_;
  std::vector<Mat3> held_;
  int most_at_node_ = 1;
  std::vector<Eigen::Matrix<double, 3, 8>> slope_;  // of the hexahedron's functions at the Gauss points
  std::vector<double> weight_;
};

}  // namespace valsalva::coupling
