// Nodes of different leaflets that are near each other: a list with a skin of half the range, made by cells,
// and made anew once a node has moved by half the skin. What is found does not depend on the list's age.
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

  /// All pairs nearer than the range at x, sorted by a and b. Valid until the next call.
  const std::vector<NearPair>& find(const Points& x);
  double range_mm() const { return range_; }

 private:
  double range_;
  Points rest_, start_;
  std::vector<int> group_;
  void list(const Points& x);

  std::vector<int> order_, first_;  // nodes sorted by cell
  std::vector<NearPair> listed_, pairs_;
  Points listed_at_;
};

}  // namespace valsalva::coupling
