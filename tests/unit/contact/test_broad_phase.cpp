#include <gtest/gtest.h>
#include <omp.h>

#include <random>

#include "contact/broad_phase.hpp"

namespace valsalva::contact {
namespace {

std::vector<Box> random_boxes(int n, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-5, 5), extent(0, size);
  std::vector<Box> boxes;
  for (int i = 0; i < n; ++i) {
    const Vec3 low(place(random), place(random), place(random));
    boxes.push_back({low, low + Vec3(extent(random), extent(random), extent(random))});
  }
  return boxes;
}

TEST(BroadPhase, EqualsBruteForceBetweenTwoSets) {
  const auto a = random_boxes(700, 1.0, 1), b = random_boxes(900, 0.6, 2);
  EXPECT_EQ(overlapping_boxes(a, b, false), overlapping_boxes_brute_force(a, b, false));
}

TEST(BroadPhase, EqualsBruteForceWithinOneSetOfVeryUnequalBoxes) {
  auto boxes = random_boxes(900, 0.3, 3);
  const auto big = random_boxes(20, 6.0, 4);
  boxes.insert(boxes.end(), big.begin(), big.end());
  EXPECT_EQ(overlapping_boxes(boxes, boxes, true), overlapping_boxes_brute_force(boxes, boxes, true));
}

TEST(BroadPhase, QueriesOutsideTheStoredRegion) {
  auto a = random_boxes(100, 1.0, 5);
  for (Box& box : a) {
    box.low += Vec3(8, 0, 0);
    box.high += Vec3(8, 0, 0);
  }
  const auto b = random_boxes(300, 2.0, 6);
  EXPECT_EQ(overlapping_boxes(a, b, false), overlapping_boxes_brute_force(a, b, false));
}

TEST(BroadPhase, FlatAndPointLikeBoxes) {
  auto boxes = random_boxes(300, 1.0, 7);
  for (Box& box : boxes) box.low[2] = box.high[2] = 0;
  boxes.push_back({Vec3::Zero(), Vec3::Zero()});
  EXPECT_EQ(overlapping_boxes(boxes, boxes, true), overlapping_boxes_brute_force(boxes, boxes, true));
  EXPECT_TRUE(overlapping_boxes({}, boxes, false).empty());
}

TEST(BroadPhase, IndependentOfTheNumberOfThreads) {
  const auto boxes = random_boxes(3000, 0.8, 8);
  omp_set_num_threads(1);
  const auto one = overlapping_boxes(boxes, boxes, true);
  omp_set_num_threads(3);
  EXPECT_EQ(one, overlapping_boxes(boxes, boxes, true));
}

}  // namespace
}  // namespace valsalva::contact
