#include "fluid/wall_force.hpp"

#include <cmath>
#include <numbers>

namespace valsalva::fluid {

WallForce::WallForce(const Grid& grid, const Distance& body) : h_(grid.h) {
  constexpr int per_cell = 2;
  const double h = grid.h, step = h / per_cell, volume = step * step * step;
  for (int k = 0; k < grid.cells[2]; ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        if (std::abs(body(grid.position(3, i, j, k))) > 3 * h) continue;
        for (int part = 0; part < per_cell * per_cell * per_cell; ++part) {
          const Vec3 offset(part % per_cell + 0.5, part / per_cell % per_cell + 0.5,
                            part / (per_cell * per_cell) + 0.5);
          const Vec3 x = grid.origin + h * Vec3(i, j, k) + step * offset;
          const double d = body(x);
          if (std::abs(d) > 2 * h) continue;
          Vec3 slope;
          for (int e = 0; e < 3; ++e) {
            const Vec3 to = 0.25 * h * Vec3::Unit(e);
            slope[e] = (body(x + to) - body(x - to)) / (0.5 * h);
          }
          const double size = slope.norm();
          if (!(size > 0.1) || std::abs(d) >= h * size) continue;
          const double away = d / size;
          const double weight = (1 + std::cos(std::numbers::pi * away / h)) / (2 * h) * volume;
          points_.push_back({x - away / size * slope, slope / size, weight});
        }
      }
    }
  }
}

double WallForce::area() const {
  double sum = 0;
  for (const Point& point : points_) sum += point.area;
  return sum;
}

WallForce::Sum WallForce::of(Flow& flow, const Vec3& x0) const {
  const double near = 1.25 * h_;
  Points places;
  for (const Point& point : points_) {
    places.push_back(point.x + near * point.normal);
    places.push_back(point.x + 2 * near * point.normal);
  }
  const std::vector<double> pressure = flow.pressure_at(places);
  const std::vector<Vec3> shear = flow.wall_shear_stress([&] {
    std::vector<WallPoint> walls;
    for (const Point& point : points_) walls.push_back({point.x, point.normal});
    return walls;
  }());
  Sum sum;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    const double p = 2 * pressure[2 * i] - pressure[2 * i + 1];
    const Vec3 force = point.area * (shear[i] - p * point.normal);
    sum.viscous += point.area * shear[i];
    sum.force += force;
    sum.moment += (point.x - x0).cross(force);
  }
  return sum;
}

}  // namespace valsalva::fluid
