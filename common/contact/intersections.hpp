// The explicit question whether anything passes through anything: every edge against every face.
#pragma once

#include "contact/collision_mesh.hpp"

namespace valsalva::contact {

/// Pairs (edge, face) of the mesh whose segment crosses the triangle at positions x. Pairs that share a node
/// (sewn ones count as one) are left out. Sorted.
std::vector<std::array<int, 2>> crossings(const CollisionMesh& mesh, const Points& x);

/// Does the open segment p-q cross the triangle's inside? Exactly coplanar pairs do not.
bool segment_crosses_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace valsalva::contact
