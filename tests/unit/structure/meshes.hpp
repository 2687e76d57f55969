// Small meshes and rigid motions that the tests of the structure share.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "structure/shell.hpp"

namespace valsalva::structure {

/// A rectangle of nx by ny cells in the plane z = 0, two triangles each, diagonals alternating.
inline ShellMesh rectangle(double width, double height, int nx, int ny, double thickness) {
  ShellMesh mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) mesh.reference.emplace_back(width * i / nx, height * j / ny, 0);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 1, d = c + 1;
      if ((i + j) % 2) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, d, c});
      }
    }
  mesh.thickness_mm.assign(mesh.reference.size(), thickness);
  return mesh;
}

inline Points moved(const Points& x, const Eigen::Quaterniond& turn, const Vec3& shift) {
  Points y;
  for (const Vec3& p : x) y.push_back(turn * p + shift);
  return y;
}

inline Points shaken(const Points& x, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Points y = x;
  for (Vec3& p : y)
    for (int d = 0; d < 3; ++d) p[d] += uniform(random);
  return y;
}

inline double largest(const Points& f) {
  double value = 0;
  for (const Vec3& p : f) value = std::max(value, p.norm());
  return value;
}

}  // namespace valsalva::structure
