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
  const auto smaller = [&](std::size_t a, std::size_t b) {
    return values[a] != values[b] ? values[a] < values[b] : a < b;
  };
  const double wanted = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  // Sorts only the part in which the value lies, halving it around its median.
  auto from = order.begin(), to = order.end();
  double below = 0;
  while (to - from > 1) {
    const auto middle = from + (to - from) / 2;
    std::nth_element(from, middle, to, smaller);
    const double lower =
        std::accumulate(from, middle, below, [&](double sum, std::size_t i) { return sum + weights[i]; });
    if (lower >= wanted) {
      to = middle;
    } else {
      from = middle;
      below = lower;
    }
  }
  return values[*from];
}

}  // namespace valsalva::metrics
