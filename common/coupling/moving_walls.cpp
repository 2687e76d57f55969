#include "coupling/moving_walls.hpp"

#include "core/errors.hpp"

namespace valsalva::coupling {

MovingWalls::MovingWalls(const fluid::Grid& grid, Kernel kernel, const std::array<bool, 3>& periodic,
                         Surroundings beyond)
    : grid_(grid), kernel_(kernel), beyond_(beyond) {
  for (int e = 0; e < 3; ++e)
    if (periodic[e]) beyond_[e].fill(Beyond::nothing);
}

double MovingWalls::signed_sum(const Weights& w, int d, bool normal) const {
  const int n = grid_.cells[d];
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const int sample = w.start + i;
    const bool below = normal ? sample <= 0 : sample < 0, above = sample >= n;
    const Beyond kind = below || above ? beyond_[d][above ? 1 : 0] : Beyond::nothing;
    if (kind == Beyond::nothing) {
      sum += w.value[i];
    } else if (!normal || (sample != 0 && sample != n)) {  // nothing acts on the side itself
      sum += normal == (kind == Beyond::wall) ? w.value[i] : -w.value[i];
    }
  }
  return sum;
}

void MovingWalls::add(const Points& x, const Velocities& walls, Points& out) const {
  bool any = false;
  for (int e = 0; e < 3; ++e)
    for (int side = 0; side < 2; ++side)
      any = any || (beyond_[e][side] == Beyond::wall && walls[e][side].squaredNorm() > 0);
  if (!any) return;
  VALSALVA_ASSERT(out.size() >= x.size());
  for (std::size_t a = 0; a < x.size(); ++a) {
    const Vec3 cell = (x[a] - grid_.origin) / grid_.h;
    for (int d = 0; d < 3; ++d) {
      double sum = 0, sign = signed_sum(weights(kernel_.along, cell[d]), d, true);
      for (int e = 0; e < 3; ++e) {
        if (e == d) continue;
        const Weights w = weights(kernel_.across, cell[e] - 0.5);
        for (int i = 0; i < 4; ++i) {
          const int sample = w.start + i;
          const int side = sample < 0 ? 0 : sample >= grid_.cells[e] ? 1 : -1;
          if (side >= 0 && beyond_[e][side] == Beyond::wall) sum += sign * w.value[i] * 2 * walls[e][side][d];
        }
        sign *= signed_sum(w, e, false);
      }
      out[a][d] += sum;
    }
  }
}

}  // namespace valsalva::coupling
