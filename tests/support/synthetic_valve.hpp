// A trileaflet valve in a straight tube along z, for tests of the coupled solver: ruled leaflets, half open
// and stress-free, with a free edge long enough to coapt and a raised middle.
//
// The attachment runs on the tube, z = height |s|^1.8 over a third of the circumference (s from -1 to 1), and
// ends in straight posts. The free edge bows inwards to `gap_mm` from the axis.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <numbers>

#include "materials/hgo.hpp"
#include "structure/shell.hpp"

namespace valsalva::test {

struct SyntheticValve {
  double radius_mm = 12.5;
  double height_mm = 11;
  double post_mm = 3;
  double gap_mm = 2.5;
  double peak_mm = 3;
  double spacing_mm = 0.5;
  double thickness_mm = 0.34;
  double base_z_mm = 0;
  double turn_rad = 0;
};

struct ValveMesh {
  structure::ShellMesh shell;
  std::vector<std::uint8_t> attached;
  std::vector<int> leaflet;      ///< of each node
  std::vector<Edge> attachment;  ///< edges of the attached line
};

inline ValveMesh synthetic_valve(const SyntheticValve& v) {
  const double pi = std::numbers::pi, half = pi / 3, r = v.radius_mm;
  const double chord_half = r * std::sin(half), sagitta = r * std::cos(half) - v.gap_mm;
  const double bow = (chord_half * chord_half + sagitta * sagitta) / (2 * sagitta);
  const double bow_angle = std::asin(chord_half / bow);
  const int columns = 2 * static_cast<int>(std::lround(0.6 * (2 * r + v.height_mm) / v.spacing_mm));
  ValveMesh mesh;
  for (int leaf = 0; leaf < 3; ++leaf) {
    const double turn = v.turn_rad + 2 * half * leaf;
    auto turned = [&](double x, double y, double z) {
      return Vec3(std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y,
                  v.base_z_mm + z);
    };
    std::vector<std::vector<int>> column(columns + 1);
    for (int c = 0; c <= columns; ++c) {
      const double s = 2.0 * c / columns - 1;
      const double z = v.height_mm * std::pow(std::abs(s), 1.8);
      const Vec3 foot = turned(r * std::cos(half * s), r * std::sin(half * s), z);
      const double t = bow_angle * s;
      const double rise = v.peak_mm * std::pow(std::cos(0.5 * pi * s), 2);
      const Vec3 top =
          turned(v.gap_mm + bow * (1 - std::cos(t)), bow * std::sin(t), v.height_mm + v.post_mm + rise);
      const int parts = std::max(1, static_cast<int>(std::lround((top - foot).norm() / v.spacing_mm)));
      for (int p = 0; p <= parts; ++p) {
        column[c].push_back(static_cast<int>(mesh.shell.reference.size()));
        mesh.shell.reference.push_back(foot + (top - foot) * p / parts);
        mesh.attached.push_back(p == 0 || c == 0 || c == columns);
        mesh.leaflet.push_back(leaf);
      }
    }
    const Points& x = mesh.shell.reference;
    for (int c = 0; c < columns; ++c) {
      const auto &left = column[c], &right = column[c + 1];
      mesh.attachment.push_back({left[0], right[0]});
      std::size_t i = 0, j = 0;
      while (i + 1 < left.size() || j + 1 < right.size()) {
        const bool advance_left =
            j + 1 == right.size() || (i + 1 < left.size() && (x[left[i + 1]] - x[right[j]]).norm() <
                                                                 (x[left[i]] - x[right[j + 1]]).norm());
        mesh.shell.triangles.push_back(advance_left ? Triangle{left[i], right[j], left[i + 1]}
                                                    : Triangle{left[i], right[j], right[j + 1]});
        ++(advance_left ? i : j);
        const Triangle& made = mesh.shell.triangles.back();
        // Families at +-8 degrees to the horizontal direction of the leaflet.
        const Vec3 normal = (x[made[1]] - x[made[0]]).cross(x[made[2]] - x[made[0]]).normalized();
        const Vec3 along = Vec3::UnitZ().cross(normal).normalized(), up = normal.cross(along);
        const double angle = 7.81 * pi / 180;
        mesh.shell.fibre1.push_back(std::cos(angle) * along + std::sin(angle) * up);
        mesh.shell.fibre2.push_back(std::cos(angle) * along - std::sin(angle) * up);
      }
    }
    for (const auto& post : {column.front(), column.back()})
      for (std::size_t i = 0; i + 1 < post.size(); ++i) mesh.attachment.push_back({post[i], post[i + 1]});
  }
  mesh.shell.thickness_mm.assign(mesh.shell.reference.size(), v.thickness_mm);
  return mesh;
}

inline structure::Shell pericardial_shell(const ValveMesh& mesh) {
  return structure::Shell(mesh.shell, std::make_shared<materials::Hgo>(materials::porcine_pericardium),
                          {1.22e6, 0.5});
}

}  // namespace valsalva::test
