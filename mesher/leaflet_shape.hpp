// Native leaflets: how large they are, and their stress-free shape in a measured root.
//
// Sizes, from the closed valve (d annulus diameter, R_n wall radius at the nadirs, R_c at the commissures, H
// height of the commissures, c coaptation height, e excess, s stretch of the closed edge under pressure):
//   closed edge    L = max(1.24 d, 2 (1 + e) R_c)                 (1.24 d: Swanson and Clark 1974, of casts
//                                                                  under pressure); stress-free: L / s
//   z_f = H - sqrt((L / (2 (1 + e)))^2 - R_c^2)                   height of the closed free edge at the axis
//   z_b = z_f - c                                                 where coaptation begins
//   leaflet length = (1 + e) (sqrt(R_n^2 + z_b^2) + c) + peak
// With R_n = R_c = d/2, H = 0.71 d, c = 0.17 d, e = 0.03 and no peak the free edge falls by 34 degrees
// (Thubrikar 1990: 34) and the length is 0.73 d (Swanson and Clark: 0.70): the published figures belong
// together.
//
// Attachment: a crown on the wall,
//   h(x) = 1 - (1 - x^2)^(1/2.7),  x in [-1, 1] from commissure to commissure, h from nadir 0 to
//   commissure 1
// (our fit to the line of Khelil et al. 2015, largest deviation 0.02 in h).
//
// Stress-free shape: half open and ruled. In each half-plane through the axis a straight line runs from the
// attachment to the free edge, so leaflets keep to their own sectors and cannot cross. Seen along the axis
// the free edge follows the wall near the commissures and turns inwards to a radius at mid leaflet, which is
// chosen so that the edge has its length. Where a line would leave the lumen it is bent inwards. Assumed: the
// course of the free edge between these constraints.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.hpp"
#include "root.hpp"

namespace valsalva::mesher {

struct LeafletProportions {
  double annulus_diameter_mm = 0;
  double junction_z_mm = 0;  ///< height of the sinotubular junction
  double commissure_height_factor = 0.71;
  double free_edge_factor = 1.24;
  double coaptation_height_factor = 0.17;
  double free_edge_excess = 0.03;
  double closed_stretch = 1;
  double free_edge_peak_factor = 0.05;
  double commissure_gap_mm = 0.8;
  double attachment_inset_mm = 0.1;
};

struct LeafletSizes {
  double commissure_z_mm = 0;
  double free_edge_mm = 0;
  double length_mm = 0;  ///< nadir to mid free edge
  double peak_mm = 0;
};

/// H = min(commissure_height_factor d, height of the junction).
double commissure_height(const LeafletProportions& proportions);

/// Attachment height at x in [-1, 1], from 0 to 1.
double crown_height(double x);

/// One leaflet between two commissures, as a map from (u, t): u in [-1, 1] from commissure to commissure in
/// growing angle, t in [0, 1] from attachment to free edge.
class LeafletShape {
 public:
  LeafletShape(const Root& root, const LeafletProportions& proportions, double from_rad, double to_rad);

  Vec3 attachment(double u) const;
  Vec3 free_edge(double u) const;
  Vec3 point(double u, double t) const { return (1 - t) * attachment(u) + t * free_edge(u); }

  const LeafletSizes& sizes() const { return sizes_; }
  /// Distance of the middle of the free edge from the nadir.
  double straight_length_mm() const { return (free_edge(0) - attachment(0)).norm(); }
  /// Dense triangles of the surface, normal towards the aorta: `across` columns, `along` rows.
  geometry::TriMesh sampled(int across, int along) const;

 private:
  struct Cylindrical {
    double radius, z;
  };
  std::vector<double> columns(int count) const;
  Cylindrical attachment_at(double u) const;
  Cylindrical free_edge_at(double u) const;
  double angle(double u) const { return middle_ + u * half_width_; }
  Vec3 off_the_wall(const Vec3& x, double from_attachment) const;
  void trace_free_edge();
  double free_edge_length() const;
  void fit_mid_radius();

  const Root& root_;
  LeafletSizes sizes_;
  double inset_;
  double middle_ = 0, half_width_ = 0;
  double nadir_radius_ = 0, commissure_radius_ = 0;
  double mid_radius_ = 0;       ///< least radius of the free edge before rounding
  double design_length_ = 0;    ///< leaflet length before rounding
  std::vector<double> edge_u_;  ///< the rounded free edge, in equal steps
  Points edge_;
};

}  // namespace valsalva::mesher
