#include "lumen_field.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/level_set.hpp"

namespace valsalva::segment {
namespace {

using geometry::GridSdf;

constexpr double margin_mm = 9;  // distances are right up to here, and every radius is smaller

GridSdf shifted(GridSdf field, double by) {
  for (float& value : field.values) value += float(by);
  return field;
}

/// sign 1: the greater of both (intersection); -1: the smaller (union).
GridSdf greatest(GridSdf a, const GridSdf& b, float sign) {
  for (std::size_t n = 0; n < a.values.size(); ++n)
    a.values[n] = sign * std::max(sign * a.values[n], sign * b.values[n]);
  return a;
}

Vec3 position(const GridSdf& grid, int i, int j, int k) {
  return grid.origin + grid.spacing * Vec3(i, j, k);
}

}  // namespace

GridSdf closed(const GridSdf& distance, double radius_mm) {
  const GridSdf grown =
      geometry::redistanced(geometry::without_cavities(shifted(distance, -radius_mm)), radius_mm + margin_mm);
  // Closing never removes: round-off of the two distances must not either.
  const GridSdf result = greatest(shifted(grown, radius_mm), distance, -1);
  return geometry::redistanced(geometry::without_cavities(result), margin_mm);
}

GridSdf parted(const GridSdf& distance, double radius_mm, const std::vector<Vec3>& seeds) {
  const GridSdf core = geometry::component_at(shifted(distance, radius_mm), seeds);
  const GridSdf body = shifted(geometry::redistanced(core, radius_mm + margin_mm), -radius_mm);
  return geometry::redistanced(geometry::component_at(greatest(body, distance, 1), seeds), margin_mm);
}

GridSdf within(const GridSdf& field, const GridSdf& body, double margin_mm) {
  return greatest(shifted(body, -margin_mm), field, 1);
}

double guard_radius(double z_mm, double half_width_mm) {
  constexpr double below_mm = 20, at_annulus_mm = 24;
  return z_mm < 0 ? below_mm : std::min(at_annulus_mm + z_mm, half_width_mm - 1);
}

void limit_to_guard(GridSdf& field, double half_width_mm, double z_lower_mm) {
  const auto [nx, ny, nz] = field.dimensions;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const Vec3 x = position(field, i, j, k);
        float& value = field.values[(std::size_t(k) * ny + j) * nx + i];
        const double beyond = std::hypot(x.x(), x.y()) - guard_radius(x.z(), half_width_mm);
        value = std::max(value, float(std::max(beyond, z_lower_mm - x.z())));
      }
}

void limit_to_channel(GridSdf& field, const geometry::Loop& annulus, double margin_mm) {
  const auto [nx, ny, nz] = field.dimensions;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec3 x = position(field, i, j, 0);
      const float guard = float(geometry::distance_to(annulus, {x.x(), x.y()}) - margin_mm);
      for (int k = 0; k < nz && position(field, i, j, k).z() < 0; ++k) {
        float& value = field.values[(std::size_t(k) * ny + j) * nx + i];
        value = std::max(value, guard);
      }
    }
}

void continue_straight(GridSdf& field, double z_lower_mm, double z_upper_mm) {
  const auto [nx, ny, nz] = field.dimensions;
  const GridSdf before = field;
  for (int k = 0; k < nz; ++k) {
    const double z = field.origin.z() + k * field.spacing;
    if (z > z_lower_mm && z < z_upper_mm) continue;
    const double held = std::clamp(z, z_lower_mm, z_upper_mm);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        Vec3 x = position(field, i, j, k);
        x.z() = held;
        field.values[(std::size_t(k) * ny + j) * nx + i] = float(before.value(x));
      }
  }
}

bool touches_guard(const GridSdf& field, double z_lower_mm, double z_upper_mm, double half_width_mm,
                   Vec3* where) {
  const auto [nx, ny, nz] = field.dimensions;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (field.at(i, j, k) >= 0) continue;
        *where = position(field, i, j, k);
        if (where->z() < z_lower_mm || where->z() > z_upper_mm) continue;
        const double away = std::hypot(where->x(), where->y());
        if (away > guard_radius(where->z(), half_width_mm) - 1.5 * field.spacing) return true;
      }
  return false;
}

}  // namespace valsalva::segment
