#include "geometry/centreline.hpp"

#include <cmath>

namespace valsalva::geometry {
namespace {

bool inside_grid(const GridSdf& grid, const Vec3& x) {
  for (int d = 0; d < 3; ++d) {
    const double index = (x[d] - grid.origin[d]) / grid.spacing;
    if (index < 0 || index > grid.dimensions[d] - 1) return false;
  }
  return true;
}

}  // namespace

std::vector<CentrelinePoint> follow(const GridSdf& lumen, const Vec3& start, const Vec3& direction,
                                    const CentrelineOptions& options) {
  std::vector<CentrelinePoint> line;
  const int memory = std::max(1, int(std::lround(options.tangent_memory_mm / options.step_mm)));
  Vec3 guess = start, tangent = direction.normalized();
  while (line.empty() || line.back().arc_mm < options.max_length_mm) {
    if (!inside_grid(lumen, guess) || lumen.value(guess) >= 0) break;
    const Plane plane = Plane::at(guess, tangent);
    const Loop loop = loop_at_origin(section(lumen, plane, options.half_width_mm, options.lattice_mm));
    if (loop.empty()) break;
    const SectionFigures found = figures(loop, plane);
    if (!inside_grid(lumen, found.centre)) break;
    const std::size_t n = line.size();
    if (n >= std::size_t(memory) && found.area_mm2 > 2 * line[n - memory].section.area_mm2) break;
    const double arc = n ? line.back().arc_mm + (found.centre - line.back().position).norm() : 0;
    line.push_back({found.centre, tangent, arc, found});
    const std::size_t back = n >= std::size_t(memory) ? n - memory : 0;
    if (n >= 3) {
      // The chord lags behind a bend by half its length; the first steps keep the given direction's weight.
      Vec3 chord = (found.centre - line[back].position).normalized();
      const double weight = std::min(1.0, double(n) / memory);
      tangent = ((1 - weight) * direction.normalized() + weight * chord).normalized();
    }
    guess = found.centre + options.step_mm * tangent;
  }
  return line;
}

}  // namespace valsalva::geometry
