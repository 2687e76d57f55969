#include "geometry/level_set.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/LevelSetRebuild.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"

namespace valsalva::geometry {
namespace {

constexpr float band = 3;  // half width of the narrow band in samples

using Dense = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;

openvdb::CoordBBox box_of(const GridSdf& grid) {
  return {openvdb::Coord(0, 0, 0),
          openvdb::Coord(grid.dimensions[0] - 1, grid.dimensions[1] - 1, grid.dimensions[2] - 1)};
}

/// Index space of the grid is index space of OpenVDB; the transform carries the spacing only.
openvdb::FloatGrid::Ptr to_vdb(const GridSdf& field) {
  openvdb::initialize();
  const float background = band * float(field.spacing);
  auto grid = openvdb::FloatGrid::create(background);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(field.spacing));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  std::vector<float> clamped(field.values.size());
  std::transform(field.values.begin(), field.values.end(), clamped.begin(),
                 [&](float v) { return std::clamp(v, -background, background); });
  openvdb::tools::copyFromDense(Dense(box_of(field), clamped.data()), *grid, 0.0f);
  return grid;
}

/// Values of the band; elsewhere the signed background.
GridSdf from_vdb(const openvdb::FloatGrid& grid, const GridSdf& shape) {
  GridSdf dense = shape;
  dense.values.assign(std::size_t(shape.dimensions[0]) * shape.dimensions[1] * shape.dimensions[2], 0.0f);
  Dense view(box_of(shape), dense.values.data());
  openvdb::tools::copyToDense(grid, view);
  return dense;
}

/// Godunov's solution of |grad d| = 1 from the smallest neighbour of each direction.
float eikonal(float a, float b, float c, float h) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  float d = a + h;
  if (d <= b) return d;
  d = 0.5f * (a + b + std::sqrt(2 * h * h - (a - b) * (a - b)));
  if (d <= c) return d;
  const float sum = a + b + c;
  return (sum + std::sqrt(std::max(0.0f, sum * sum - 3 * (a * a + b * b + c * c - h * h)))) / 3;
}

/// Distances beyond the band from those inside it; signs are there already.
void sweep(GridSdf& distance, double reach_mm) {
  const auto [nx, ny, nz] = distance.dimensions;
  const float h = float(distance.spacing), edge = band * h * 0.999f;
  const float far = std::numeric_limits<float>::max(), reach = float(reach_mm);
  std::vector<float> d(distance.values.size());
  std::vector<char> fixed(d.size());
  for (std::size_t n = 0; n < d.size(); ++n) {
    const float magnitude = std::abs(distance.values[n]);
    fixed[n] = magnitude < edge;
    d[n] = fixed[n] ? magnitude : far;
  }
  const std::size_t sx = 1, sy = nx, sz = std::size_t(nx) * ny;
  for (int direction = 0; direction < 8; ++direction)
    for (int kk = 0; kk < nz; ++kk)
      for (int jj = 0; jj < ny; ++jj)
        for (int ii = 0; ii < nx; ++ii) {
          const int i = direction & 1 ? nx - 1 - ii : ii, j = direction & 2 ? ny - 1 - jj : jj,
                    k = direction & 4 ? nz - 1 - kk : kk;
          const std::size_t n = i * sx + j * sy + k * sz;
          if (fixed[n]) continue;
          const float a = std::min(i > 0 ? d[n - sx] : far, i + 1 < nx ? d[n + sx] : far);
          const float b = std::min(j > 0 ? d[n - sy] : far, j + 1 < ny ? d[n + sy] : far);
          const float c = std::min(k > 0 ? d[n - sz] : far, k + 1 < nz ? d[n + sz] : far);
          if (std::min({a, b, c}) < reach) d[n] = std::min(d[n], eikonal(a, b, c, h));
        }
  // Beyond the reach, or without any surface.
  const float none = std::min(h * float(nx + ny + nz), reach + h);
  for (std::size_t n = 0; n < d.size(); ++n)
    distance.values[n] = std::copysign(std::min(d[n], none), distance.values[n]);
}

std::vector<char> reached(const GridSdf& field, const std::vector<std::size_t>& starts, bool inside) {
  const auto [nx, ny, nz] = field.dimensions;
  std::vector<char> marked(field.values.size(), 0);
  std::vector<std::size_t> stack;
  const auto visit = [&](std::size_t n) {
    if (!marked[n] && (field.values[n] < 0) == inside) {
      marked[n] = 1;
      stack.push_back(n);
    }
  };
  for (std::size_t n : starts) visit(n);
  const std::size_t sy = nx, sz = std::size_t(nx) * ny;
  while (!stack.empty()) {
    const std::size_t n = stack.back();
    stack.pop_back();
    const int i = int(n % sy), j = int(n % sz / sy), k = int(n / sz);
    if (i > 0) visit(n - 1);
    if (i + 1 < nx) visit(n + 1);
    if (j > 0) visit(n - sy);
    if (j + 1 < ny) visit(n + sy);
    if (k > 0) visit(n - sz);
    if (k + 1 < nz) visit(n + sz);
  }
  return marked;
}

}  // namespace

GridSdf redistanced(const GridSdf& field, double reach_mm) {
  const auto rebuilt = openvdb::tools::levelSetRebuild(*to_vdb(field), 0.0f, band);
  GridSdf distance = from_vdb(*rebuilt, field);
  sweep(distance, reach_mm);
  return distance;
}

GridSdf signed_distance(const TriMesh& closed, const GridSdf& shape) {
  openvdb::initialize();
  const auto transform = openvdb::math::Transform::createLinearTransform(shape.spacing);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& p : closed.points) {
    const Vec3 x = p - shape.origin;
    points.emplace_back(float(x.x()), float(x.y()), float(x.z()));
  }
  for (const Triangle& t : closed.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles, band);
  GridSdf distance = from_vdb(*grid, shape);
  sweep(distance, 1e9);
  return distance;
}

TriMesh zero_surface(const GridSdf& field) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*to_vdb(field), points, triangles, quads, 0.0);
  TriMesh mesh;
  for (const auto& p : points) mesh.points.push_back(field.origin + Vec3(p.x(), p.y(), p.z()));
  // OpenVDB's faces turn the other way round.
  for (const auto& t : triangles) mesh.triangles.push_back({int(t[2]), int(t[1]), int(t[0])});
  for (const auto& q : quads) {
    // The shorter diagonal makes the better triangles.
    const auto at = [&](int c) { return mesh.points[q[c]]; };
    if ((at(0) - at(2)).squaredNorm() <= (at(1) - at(3)).squaredNorm()) {
      mesh.triangles.push_back({int(q[2]), int(q[1]), int(q[0])});
      mesh.triangles.push_back({int(q[3]), int(q[2]), int(q[0])});
    } else {
      mesh.triangles.push_back({int(q[3]), int(q[1]), int(q[0])});
      mesh.triangles.push_back({int(q[3]), int(q[2]), int(q[1])});
    }
  }
  return mesh;
}

GridSdf smoothed(const GridSdf& distance, double length_mm) {
  const double target = volume_inside(distance);
  auto grid = to_vdb(distance);
  openvdb::tools::LevelSetFilter<openvdb::FloatGrid> filter(*grid);
  // One step of OpenVDB's flow advances the pseudo-time by spacing^2 / 6.
  const int steps = int(std::ceil(3 * length_mm * length_mm / (distance.spacing * distance.spacing)));
  for (int step = 0; step < steps; ++step) filter.meanCurvature();
  GridSdf flowed = redistanced(from_vdb(*grid, distance), 4 * length_mm + 2 * distance.spacing);
  double low = -2 * length_mm, high = 2 * length_mm;  // of the offset outward, by bisection
  GridSdf moved = flowed;
  for (int iteration = 0; iteration < 40; ++iteration) {
    const double offset = 0.5 * (low + high);
    for (std::size_t n = 0; n < moved.values.size(); ++n) moved.values[n] = flowed.values[n] - float(offset);
    const double volume = volume_inside(moved);
    if (std::abs(volume - target) <= 1e-4 * target) break;
    (volume < target ? low : high) = offset;
  }
  return moved;
}

double volume_inside(const GridSdf& distance) {
  const double h = distance.spacing;
  double sum = 0;
  for (float value : distance.values) sum += std::clamp(0.5 - value / h, 0.0, 1.0);
  return sum * h * h * h;
}

GridSdf component_at(const GridSdf& field, const std::vector<Vec3>& seeds) {
  std::vector<std::size_t> starts;
  for (const Vec3& seed : seeds) {
    const Vec3 index = (seed - field.origin) / field.spacing;
    std::array<int, 3> at{};
    for (int d = 0; d < 3; ++d) at[d] = std::clamp(int(std::lround(index[d])), 0, field.dimensions[d] - 1);
    starts.push_back((std::size_t(at[2]) * field.dimensions[1] + at[1]) * field.dimensions[0] + at[0]);
  }
  const std::vector<char> kept = reached(field, starts, true);
  GridSdf result = field;
  for (std::size_t n = 0; n < kept.size(); ++n)
    if (field.values[n] < 0 && !kept[n]) result.values[n] = float(field.spacing) / 2;
  return result;
}

GridSdf without_cavities(const GridSdf& field) {
  const auto [nx, ny, nz] = field.dimensions;
  std::vector<std::size_t> starts;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        if (i == 0 || j == 0 || k == 0 || i + 1 == nx || j + 1 == ny || k + 1 == nz)
          starts.push_back((std::size_t(k) * ny + j) * nx + i);
  const std::vector<char> outside = reached(field, starts, false);
  GridSdf result = field;
  for (std::size_t n = 0; n < outside.size(); ++n)
    if (field.values[n] >= 0 && !outside[n]) result.values[n] = -float(field.spacing) / 2;
  return result;
}

GridSdf cropped(const GridSdf& field, const std::array<int, 3>& low, const std::array<int, 3>& high) {
  GridSdf part;
  part.spacing = field.spacing;
  part.origin = field.origin + field.spacing * Vec3(low[0], low[1], low[2]);
  for (int d = 0; d < 3; ++d) {
    VALSALVA_ASSERT(low[d] >= 0 && low[d] <= high[d] && high[d] < field.dimensions[d]);
    part.dimensions[d] = high[d] - low[d] + 1;
  }
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i) part.values.push_back(field.at(i, j, k));
  return part;
}

}  // namespace valsalva::geometry
