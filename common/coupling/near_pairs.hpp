// Nodes of different leaflets that are near each other, by a cell list.
#pragma once

#include <vector>

#include "core/types.hpp"

namespace valsalva::coupling {

struct NearPair {
  int a, b;                  ///< a < b, of different groups
  double distance_mm;        ///< now
  double rest_distance_mm;   ///< in the rest shape
  double start_distance_mm;  ///< at the start of the run
};

class NearPairs {
 public:
  /// group: nodes of the same group do not see each other; negative: the node takes no part. InputError when
  /// the range is not positive.
  NearPairs(double range_mm, Points rest, Points start, std::vector<int> group);

  /// All pairs nearer than the range at x, sorted by a. Valid until the next call.
  const std::vector<NearPair>& find(const Points& x);
  double range_mm() const { return range_; }

 private:
  double range_;
  Points rest_, start_;
  std::vector<int> group_;
  std::vector<int> order_, first_;  // nodes sorted by cell
  std::vector<NearPair> pairs_;
};

}  // namespace valsalva::coupling
