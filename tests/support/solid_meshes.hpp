// Boxes of solid elements for tests: the unit cube in cells, each position mapped.
#pragma once

#include <functional>
#include <map>

#include "structure/solid.hpp"

namespace valsalva::structure {

/// How tetrahedra fill a cell: all along one diagonal, or mirrored from cell to cell, so that with even
/// numbers of cells the edges run into all corners of the box.
enum class Cut { one_way, mirrored };

inline SolidMesh solid_box(
    Shape shape, std::array<int, 3> cells,
    const std::function<Vec3(const Vec3&)>& map = [](const Vec3& x) { return x; }, Cut cut = Cut::one_way) {
  SolidMesh mesh;
  Points unit;
  const bool fine = shape == Shape::hex27;
  const int per = fine ? 2 : 1;  // lattice steps a cell
  const std::array<int, 3> n{per * cells[0] + 1, per * cells[1] + 1, per * cells[2] + 1};
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        unit.emplace_back(double(i) / (n[0] - 1), double(j) / (n[1] - 1), double(k) / (n[2] - 1));
  std::map<Edge, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [at, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)}, int(unit.size()));
    if (fresh) unit.push_back(Vec3(0.5 * (unit[a] + unit[b])));
    return at->second;
  };
  const std::vector<Vec3> corners = node_coordinates(fine ? Shape::hex27 : Shape::hex8);
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        std::vector<int> hex;
        for (const Vec3& c : corners) {
          const auto at = [&](int cell, double along) {
            return per * cell + int(std::lround(0.5 * per * (1 + along)));
          };
          hex.push_back((at(k, c.z()) * n[1] + at(j, c.y())) * n[0] + at(i, c.x()));
        }
        if (shape == Shape::hex8 || shape == Shape::hex27) {
          mesh.add(shape, hex);
          continue;
        }
        bool reversed = false;
        if (cut == Cut::mirrored) {
          const std::array<std::array<int, 8>, 3> mirror{
              {{1, 0, 3, 2, 5, 4, 7, 6}, {3, 2, 1, 0, 7, 6, 5, 4}, {4, 5, 6, 7, 0, 1, 2, 3}}};
          const std::array<int, 3> cell{i, j, k};
          for (int d = 0; d < 3; ++d) {
            if (cell[d] % 2 == 0) continue;
            const std::vector<int> before = hex;
            for (int a = 0; a < 8; ++a) hex[a] = before[mirror[d][a]];
            reversed = !reversed;
          }
        }
        // Kuhn's six tetrahedra around the diagonal 0-6; they match from cell to cell.
        for (const Edge& way : {Edge{1, 2}, {2, 3}, {3, 7}, {7, 4}, {4, 5}, {5, 1}}) {
          std::vector<int> tet{hex[0], hex[way[0]], hex[way[1]], hex[6]};
          if (reversed) std::swap(tet[1], tet[2]);
          if (shape == Shape::tet10)
            for (const Edge& e : {Edge{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}})
              tet.push_back(middle(tet[e[0]], tet[e[1]]));
          mesh.add(shape, tet);
        }
      }
  for (const Vec3& x : unit) mesh.reference.push_back(map(x));
  return mesh;
}

}  // namespace valsalva::structure
