// Triangle meshes of curved rectangles, from regular to unstructured, and their borders.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "structure/shell.hpp"

namespace valsalva::test {

enum class Pattern {
  one_way,      ///< all diagonals parallel: regular
  alternating,  ///< valences 4 and 8
  unstructured  ///< nodes shaken by up to a quarter of a cell, diagonals by Delaunay's rule: valences 4 to 8
};

inline const char* name_of(Pattern p) {
  return p == Pattern::one_way ? "one way" : p == Pattern::alternating ? "alternating" : "unstructured";
}

struct SheetMesh {
  Points plane;  ///< (u, v, 0) in [0, width] x [0, height]
  std::vector<Triangle> triangles;
  int nx = 0, ny = 0;
};

namespace detail {

inline double turn(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

// Flips diagonals until the sums of opposite angles are at most pi.
inline void delaunay(const Points& x, std::vector<Triangle>& triangles) {
  const auto cot = [&](int at, int b, int c) {
    const Vec3 p = x[b] - x[at], q = x[c] - x[at];
    return p.dot(q) / std::abs(p.x() * q.y() - p.y() * q.x());
  };
  for (bool flipped = true; flipped;) {
    flipped = false;
    std::map<Edge, std::pair<int, int>> sides;  // directed edge: triangle, opposite
    for (int e = 0; e < static_cast<int>(triangles.size()); ++e)
      for (int k = 0; k < 3; ++k)
        sides[{triangles[e][k], triangles[e][(k + 1) % 3]}] = {e, triangles[e][(k + 2) % 3]};
    std::vector<bool> touched(triangles.size(), false);
    for (const auto& [edge, side] : sides) {
      const auto [a, b] = edge;
      const auto other = sides.find({b, a});
      if (a > b || other == sides.end()) continue;
      const auto [e, c] = side;
      const auto [f, d] = other->second;
      if (touched[e] || touched[f]) continue;
      if (cot(c, a, b) + cot(d, a, b) >= -1e-9) continue;
      if (turn(x[c], x[a], x[d]) <= 0 || turn(x[d], x[b], x[c]) <= 0) continue;
      triangles[e] = {c, a, d};
      triangles[f] = {d, b, c};
      touched[e] = touched[f] = true;
      flipped = true;
    }
  }
}

}  // namespace detail

/// nx by ny cells. Border nodes of the unstructured mesh stay on the border.
inline SheetMesh sheet(double width, double height, int nx, int ny, Pattern pattern, unsigned seed = 1) {
  SheetMesh mesh{{}, {}, nx, ny};
  std::mt19937 random(seed);
  const auto shake = [&] {
    return pattern == Pattern::unstructured ? random() / double(random.max()) * 0.5 - 0.25 : 0;
  };
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const double du = shake(), dv = shake();
      mesh.plane.emplace_back(width * (i + (i > 0 && i < nx ? du : 0)) / nx,
                              height * (j + (j > 0 && j < ny ? dv : 0)) / ny, 0);
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 1, d = c + 1;
      const bool other = pattern == Pattern::alternating    ? (i + j) % 2
                         : pattern == Pattern::unstructured ? random() % 2
                                                            : false;
      if (other) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, d, c});
      }
    }
  if (pattern == Pattern::unstructured) detail::delaunay(mesh.plane, mesh.triangles);
  return mesh;
}

inline Points mapped(const SheetMesh& mesh, const std::function<Vec3(double, double)>& shape) {
  Points x;
  for (const Vec3& p : mesh.plane) x.push_back(shape(p.x(), p.y()));
  return x;
}

/// Ascending border edges whose two ends satisfy the condition on (u, v).
inline std::vector<Edge> border_edges(const SheetMesh& mesh, const std::function<bool(double, double)>& on) {
  std::map<Edge, int> count;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      ++count[{std::min(a, b), std::max(a, b)}];
    }
  std::vector<Edge> edges;
  for (const auto& [edge, sides] : count)
    if (sides == 1 && on(mesh.plane[edge[0]].x(), mesh.plane[edge[0]].y()) &&
        on(mesh.plane[edge[1]].x(), mesh.plane[edge[1]].y()))
      edges.push_back(edge);
  return edges;
}

inline int node_near(const Points& points, const Vec3& where) {
  int best = 0;
  for (std::size_t a = 0; a < points.size(); ++a)
    if ((points[a] - where).norm() < (points[best] - where).norm()) best = static_cast<int>(a);
  return best;
}

inline structure::ShellMesh shell_mesh(const SheetMesh& mesh, Points reference, double thickness) {
  structure::ShellMesh shell;
  shell.reference = std::move(reference);
  shell.triangles = mesh.triangles;
  shell.thickness_mm.assign(shell.reference.size(), thickness);
  return shell;
}

}  // namespace valsalva::test
