#include "metrics/statistics.hpp"

#include <algorithm>
#include <numeric>

#include "core/errors.hpp"

namespace valsalva::metrics {

double weighted_percentile(const std::vector<double>& values, const std::vector<double>& weights,
                           double share) {
  VALSALVA_ASSERT(values.size() == weights.size());
  if (values.empty()) return 0;
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] != values[b] ? values[a] < values[b] : a < b;
  });
  const double wanted = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  double below = 0;
  for (const std::size_t i : order) {
    below += weights[i];
    if (below >= wanted) return values[i];
  }
  return values[order.back()];
}

}  // namespace valsalva::metrics
