// Centreline of a tube given as a level set: the centroids of its own normal sections, followed step by step.
#pragma once

#include "geometry/measure.hpp"

namespace valsalva::geometry {

struct CentrelinePoint {
  Vec3 position = Vec3::Zero();
  Vec3 tangent = Vec3::UnitZ();
  double arc_mm = 0;  ///< from the start, along the line
  SectionFigures section;
};

struct CentrelineOptions {
  double step_mm = 1;
  double max_length_mm = 200;
  double half_width_mm = 40;  ///< of the square in which a section is looked for
  double lattice_mm = 0.5;
  double tangent_memory_mm = 8;  ///< the tangent is the chord over this length: short wobbles do not turn it
};

/// From `start` (inside) towards `direction`, until the lumen ends, the grid ends, or the section has more
/// than doubled its area over the tangent memory. Empty when `start` lies outside.
std::vector<CentrelinePoint> follow(const GridSdf& lumen, const Vec3& start, const Vec3& direction,
                                    const CentrelineOptions& options);

}  // namespace valsalva::geometry
