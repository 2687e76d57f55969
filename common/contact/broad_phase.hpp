// Which boxes of one set overlap which of another: a uniform grid over the first set, queried by the second.
//
// Deterministic: the answer is sorted by (first, second), whatever the number of threads.
#pragma once

#include <array>
#include <vector>

#include "core/types.hpp"

namespace valsalva::contact {

struct Box {
  Vec3 low, high;
  bool overlaps(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

using IndexPair = std::array<int, 2>;

/// All (i, j) with queries[i] overlapping stored[j]; with `upper` only j > i (a set against itself).
std::vector<IndexPair> overlapping_boxes(const std::vector<Box>& queries, const std::vector<Box>& stored,
                                         bool upper);
/// The same by comparing all with all: the oracle of the tests.
std::vector<IndexPair> overlapping_boxes_brute_force(const std::vector<Box>& queries,
                                                     const std::vector<Box>& stored, bool upper);

}  // namespace valsalva::contact
