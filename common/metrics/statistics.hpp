// Weighted percentile: the smallest value such that the given share of the weight lies at or below it.
#pragma once

#include <vector>

namespace valsalva::metrics {

/// share: 0 to 1. Zero for no values.
double weighted_percentile(const std::vector<double>& values, const std::vector<double>& weights,
                           double share);

}  // namespace valsalva::metrics
