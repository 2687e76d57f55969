// Sets of nodes by place, in the reference shape. Lengths mm.
//
//   box       low <= x <= high (widened by the tolerance)
//   plane     |n . (x - p)| <= tolerance; with inside: n . (x - p) <= tolerance
//   sphere    ||x - p| - R| <= tolerance; with inside: |x - p| <= R + tolerance
//   cylinder  the same with the distance from the axis (p, n)
//   nearest   the one node nearest to p (the first of several)
#pragma once

#include "core/types.hpp"

namespace valsalva::assembly {

enum class Place { box, plane, sphere, cylinder, nearest };

struct Selection {
  Place place = Place::box;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  Vec3 point = Vec3::Zero(), direction = Vec3::UnitZ();
  double radius = 0;
  bool inside = false;
  double tolerance = 1e-6;
};

/// Node numbers, ascending; may be empty.
std::vector<int> select(const Points& points, const Selection& s);

}  // namespace valsalva::assembly
