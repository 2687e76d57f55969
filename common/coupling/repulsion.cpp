#include "coupling/repulsion.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::coupling {

Repulsion::Repulsion(const RepulsionParameters& parameters, Points rest, Points start, std::vector<int> group,
                     std::vector<double> area)
    : parameters_(parameters),
      rest_x_(std::move(rest)),
      start_x_(std::move(start)),
      group_(std::move(group)),
      area_(std::move(area)),
      range_(std::max(parameters.contact.range_mm, parameters.parting.range_mm)),
      nearest_(range_) {
  VALSALVA_ASSERT(group_.size() == area_.size() && start_x_.size() == area_.size() &&
                  rest_x_.size() == area_.size());
  for (const auto& cone : {parameters.contact, parameters.parting})
    if (!(cone.range_mm > 0) || !(cone.pressure_Pa >= 0))
      throw InputError("coupling: repulsion of {} Pa over {} mm; expected a pressure >= 0 and a range > 0",
                       cone.pressure_Pa, cone.range_mm);
}

double Repulsion::add_forces(const Points& x, Points& force) {
  VALSALVA_ASSERT(x.size() == group_.size() && force.size() == x.size());
  const double range = range_;
  nearest_ = range;
  pairs_.clear();
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (std::size_t a = 0; a < x.size(); ++a) {
    if (group_[a] < 0) continue;
    low = low.cwiseMin(x[a]);
    high = high.cwiseMax(x[a]);
  }
  if (!(low.x() <= high.x())) return 0;
  std::array<int, 3> cells;
  for (int d = 0; d < 3; ++d) cells[d] = static_cast<int>((high[d] - low[d]) / range) + 1;
  auto cell_of = [&](const Vec3& p) {
    std::array<int, 3> c;
    for (int d = 0; d < 3; ++d) c[d] = std::min(cells[d] - 1, static_cast<int>((p[d] - low[d]) / range));
    return c;
  };
  auto flat = [&](int i, int j, int k) {
    return (static_cast<std::size_t>(k) * cells[1] + j) * cells[0] + i;
  };
  // Counting sort of the nodes into cells keeps their order within a cell.
  start_.assign(static_cast<std::size_t>(cells[0]) * cells[1] * cells[2] + 1, 0);
  for (std::size_t a = 0; a < x.size(); ++a)
    if (group_[a] >= 0) {
      const auto c = cell_of(x[a]);
      ++start_[flat(c[0], c[1], c[2]) + 1];
    }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  order_.resize(start_.back());
  std::vector<int> fill(start_.begin(), start_.end() - 1);
  for (std::size_t a = 0; a < x.size(); ++a)
    if (group_[a] >= 0) {
      const auto c = cell_of(x[a]);
      order_[fill[flat(c[0], c[1], c[2])]++] = static_cast<int>(a);
    }

  double energy = 0;
  for (std::size_t a = 0; a < x.size(); ++a) {
    if (group_[a] < 0) continue;
    const auto c = cell_of(x[a]);
    for (int k = std::max(0, c[2] - 1); k <= std::min(cells[2] - 1, c[2] + 1); ++k)
      for (int j = std::max(0, c[1] - 1); j <= std::min(cells[1] - 1, c[1] + 1); ++j) {
        const int begin = start_[flat(std::max(0, c[0] - 1), j, k)];
        const int end = start_[flat(std::min(cells[0] - 1, c[0] + 1), j, k) + 1];
        for (int n = begin; n < end; ++n) {
          const std::size_t b = order_[n];
          if (b <= a || group_[b] == group_[a]) continue;
          const Vec3 apart = x[a] - x[b];
          const double square = apart.squaredNorm();
          if (square >= range * range || square == 0) continue;
          const double d = std::sqrt(square);
          const double rest = (rest_x_[a] - rest_x_[b]).norm(), start = (start_x_[a] - start_x_[b]).norm();
          double push = 0, stiffness = 0;
          for (const auto& cone : {parameters_.contact, parameters_.parting}) {
            const double full = std::min(cone.range_mm, rest), begun = std::min(full, start);
            const double reach = begun + growth_ * (full - begun);
            if (d >= reach) continue;
            const double closeness = 1 - d / reach;
            const double strength =
                3 * cone.pressure_Pa / (M_PI * cone.range_mm * cone.range_mm) * area_[a] * area_[b];
            push += strength * closeness;
            stiffness += strength / reach;
            energy += 0.5 * strength * reach * closeness * closeness;
          }
          if (push == 0) continue;
          const Vec3 direction = apart / d;
          pairs_.push_back({static_cast<int>(a), static_cast<int>(b), stiffness, direction});
          force[a] += push * direction;
          force[b] -= push * direction;
          nearest_ = std::min(nearest_, d);
        }
      }
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
