#include "metrics/probes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::metrics {

namespace {

template <class Visit>
void lumen_faces(const fluid::Flow& flow, int plane, Visit&& visit) {
  const fluid::Slab& slab = flow.slab();
  const int k = plane - slab.first;
  if (k < 0 || k >= slab.w_planes()) return;
  for (int j = 0; j < slab.grid.cells[1]; ++j) {
    const std::uint8_t* owner = flow.solids().owner_row(2, j, k);
    for (int i = 0; i < slab.grid.cells[0]; ++i)
      if (owner[i] == 0) visit(i, j, k);
  }
}

}  // namespace

double power_through(const fluid::Flow& flow, int plane, double pressure) {
  const double area = flow.grid().h * flow.grid().h, density = flow.parameters().density;
  double power = 0;
  lumen_faces(flow, plane, [&](int i, int j, int k) {
    const double w = flow.velocity()[2](i, j, k);
    power += area * w * (pressure + 0.5 * density * w * w);
  });
  return mpi::sum(flow.slab().comm, power);
}

double largest_axial_velocity(const fluid::Flow& flow, int first, int last) {
  double largest = 0;
  for (int plane = first; plane <= last; ++plane)
    lumen_faces(flow, plane,
                [&](int i, int j, int k) { largest = std::max(largest, flow.velocity()[2](i, j, k)); });
  return mpi::max(flow.slab().comm, largest);
}

ParavalvularGap::ParavalvularGap(const fluid::Flow& flow, const Points& skirt, double z_mm)
    : plane_(flow.plane_at(z_mm)) {
  constexpr int sectors = 72;
  const fluid::Grid& grid = flow.grid();
  const double z = grid.position(2, 0, 0, plane_).z();
  Vec3 centre = Vec3::Zero();
  std::vector<Vec3> near;
  for (const Vec3& x : skirt)
    if (std::abs(x.z() - z) < 2 * grid.h) near.push_back(x);
  if (near.empty())
    throw InputError("metrics: no node of the skirt is near the plane z = {:.2f} mm of the paravalvular gap",
                     z);
  for (const Vec3& x : near) centre += x / static_cast<double>(near.size());
  const auto sector_of = [&](double x, double y) {
    const double turn = std::atan2(y - centre.y(), x - centre.x()) / (2 * std::numbers::pi) + 0.5;
    return std::min(sectors - 1, static_cast<int>(turn * sectors));
  };
  std::vector<double> radius(sectors, 0);
  for (const Vec3& x : near) {
    double& r = radius[sector_of(x.x(), x.y())];
    r = std::max(r, std::hypot(x.x() - centre.x(), x.y() - centre.y()));
  }
  // A sector without a node takes the larger of its nearest filled neighbours.
  const std::vector<double> filled = radius;
  for (int s = 0; s < sectors; ++s)
    for (int away = 1; away < sectors && radius[s] == 0; ++away)
      radius[s] = std::max(filled[(s + away) % sectors], filled[(s + sectors - away) % sectors]);
  lumen_faces(flow, plane_, [&](int i, int j, int k) {
    const Vec3 x = grid.position(2, i, j, plane_);
    if (std::hypot(x.x() - centre.x(), x.y() - centre.y()) > radius[sector_of(x.x(), x.y())])
      faces_.push_back({i, j, k});
  });
  area_mm2_ = mpi::sum(flow.slab().comm, static_cast<double>(faces_.size())) * grid.h * grid.h;
}

double ParavalvularGap::flow_through(const fluid::Flow& flow) const {
  double sum = 0;
  for (const auto& [i, j, k] : faces_) sum += flow.velocity()[2](i, j, k);
  return mpi::sum(flow.slab().comm, sum * flow.grid().h * flow.grid().h);
}

}  // namespace valsalva::metrics
