// Small scenes that several contact tests share.
#pragma once

#include "contact/body_contact.hpp"

namespace valsalva::contact::test {

/// n x n squares of side `edge`, two triangles each, in the plane z.
struct Sheet {
  Points points;
  std::vector<Triangle> triangles;
};
inline Sheet sheet(int n, double edge, double z) {
  Sheet s;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) s.points.emplace_back(i * edge, j * edge, z);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      s.triangles.push_back({a, b, d});
      s.triangles.push_back({a, d, c});
    }
  return s;
}

/// Two sheets of the same group, far apart in the reference; `upper` starts at node lower.points.size().
struct TwoSheets {
  Sheet lower, upper;
  Points reference;
  CollisionMesh mesh;
  explicit TwoSheets(int n = 4, double edge = 0.5, double radius = 0.05)
      : lower(sheet(n, edge, 0)), upper(sheet(n, edge, 5)), reference(join(lower, upper)), mesh(reference) {
    mesh.add_shell({"lower", 0}, 0, lower.triangles, std::vector<double>(lower.points.size(), radius));
    mesh.add_shell({"upper", 0}, static_cast<int>(lower.points.size()), upper.triangles,
                   std::vector<double>(upper.points.size(), radius));
  }
  static Points join(const Sheet& a, const Sheet& b) {
    Points all = a.points;
    all.insert(all.end(), b.points.begin(), b.points.end());
    return all;
  }
};

inline structure::Configuration at(const Points& x) {
  structure::Configuration now;
  now.x = x;
  now.v.assign(x.size(), Vec3::Zero());
  return now;
}

inline structure::Forces forces_for(const structure::Configuration& now) {
  structure::Forces f;
  f.reset(now.x.size(), now.rotation.size());
  return f;
}

}  // namespace valsalva::contact::test
