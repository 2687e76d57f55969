#include "coupling/repulsion.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::coupling {

Repulsion::Repulsion(const RepulsionParameters& parameters, std::vector<double> area)
    : parameters_(parameters), area_(std::move(area)), nearest_(parameters.range_mm) {
  if (!(parameters.range_mm > 0) || !(parameters.pressure_Pa >= 0))
    throw InputError("coupling: repulsion of {} Pa over {} mm; expected a pressure >= 0 and a range > 0",
                     parameters.pressure_Pa, parameters.range_mm);
}

double Repulsion::add_forces(const Points& x, const std::vector<NearPair>& near, Points& force) {
  VALSALVA_ASSERT(x.size() == area_.size() && force.size() == x.size());
  const double range = parameters_.range_mm;
  const double per_area = 3 * parameters_.pressure_Pa / (M_PI * range * range);
  nearest_ = range;
  pairs_.clear();
  double energy = 0;
  for (const NearPair& pair : near) {
    const double full = std::min(range, pair.rest_distance_mm);
    const double begun = std::min(full, pair.start_distance_mm);
    const double reach = begun + growth_ * (full - begun);
    if (pair.distance_mm >= reach) continue;
    const double closeness = 1 - pair.distance_mm / reach;
    const double strength = per_area * area_[pair.a] * area_[pair.b];
    const Vec3 direction = (x[pair.a] - x[pair.b]) / pair.distance_mm;
    pairs_.push_back({pair.a, pair.b, strength / reach, direction});
    force[pair.a] += strength * closeness * direction;
    force[pair.b] -= strength * closeness * direction;
    energy += 0.5 * strength * reach * closeness * closeness;
    nearest_ = std::min(nearest_, pair.distance_mm);
  }
  return energy;
}

void Repulsion::add_tangent_product(const Points& y, Points& out) const {
  for (const Pair& pair : pairs_) {
    const Vec3 change = pair.stiffness * pair.direction.dot(y[pair.a] - y[pair.b]) * pair.direction;
    out[pair.a] += change;
    out[pair.b] -= change;
  }
}

}  // namespace valsalva::coupling
