#include "geometry/grid_sdf.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::geometry {
namespace {

struct Location {
  std::array<int, 3> low;
  std::array<double, 3> fraction;
};

Location locate(const GridSdf& grid, const Vec3& x) {
  Location found;
  for (int d = 0; d < 3; ++d) {
    const double last = grid.dimensions[d] - 1;
    const double position = std::clamp((x[d] - grid.origin[d]) / grid.spacing, 0.0, last);
    found.low[d] = std::min(static_cast<int>(position), std::max(0, grid.dimensions[d] - 2));
    found.fraction[d] = position - found.low[d];
  }
  return found;
}

template <class Sample>
auto interpolate(const GridSdf& grid, const Location& where, Sample&& sample) {
  using Result = decltype(sample(0, 0, 0));
  Result sum = Result(0 * sample(where.low[0], where.low[1], where.low[2]));
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<int, 3> index{};
    for (int d = 0; d < 3; ++d) {
      const int upper = (corner >> d) & 1;
      weight *= upper ? where.fraction[d] : 1 - where.fraction[d];
      index[d] = std::min(where.low[d] + upper, grid.dimensions[d] - 1);
    }
    if (weight > 0) sum = Result(sum + weight * sample(index[0], index[1], index[2]));
  }
  return sum;
}

}  // namespace

double GridSdf::value(const Vec3& x) const {
  return interpolate(*this, locate(*this, x), [this](int i, int j, int k) { return double(at(i, j, k)); });
}

Vec3 GridSdf::gradient(const Vec3& x) const {
  const auto difference = [this](int i, int j, int k) -> Vec3 {
    const std::array<int, 3> centre{i, j, k};
    Vec3 slope;
    for (int d = 0; d < 3; ++d) {
      auto low = centre, high = centre;
      low[d] = std::max(0, centre[d] - 1);
      high[d] = std::min(dimensions[d] - 1, centre[d] + 1);
      const double rise = at(high[0], high[1], high[2]) - at(low[0], low[1], low[2]);
      slope[d] = high[d] > low[d] ? rise / (spacing * (high[d] - low[d])) : 0.0;
    }
    return slope;
  };
  return interpolate(*this, locate(*this, x), difference);
}

}  // namespace valsalva::geometry
