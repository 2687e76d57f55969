// Still pictures without a display: a z-buffer rasteriser with smooth shading and supersampling.
//
// Parallel projection, so that a scale bar holds over the whole picture. Opaque surfaces are drawn first;
// transparent ones after them, triangle by triangle from far to near. Two-sided Lambert shading from a light
// above the viewer's left shoulder, over an ambient part that falls with the density of what lies close in
// front (depth differences in a small neighbourhood), which separates struts and leaflets from what is behind
// them.
#pragma once

#include <vector>

#include "render/shapes.hpp"

namespace valsalva::report {

struct Camera {
  Vec3 target = Vec3::Zero();   ///< shown in the middle
  Vec3 toward = Vec3(0, 1, 0);  ///< direction of view
  Vec3 up = Vec3(0, 0, 1);
  double mm_per_pixel = 0.1;
  int width = 800, height = 800;  ///< pixels of the finished picture

  /// The same view, moved and scaled so that the box fills the picture but for a margin.
  Camera framing(const Box& box, double margin = 0.04) const;
};

/// samples: supersampling a side; the finished picture averages samples x samples.
Image render(const std::vector<Surface>& surfaces, const Camera& camera, int samples = 2);

}  // namespace valsalva::report
