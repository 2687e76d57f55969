#include "coupling/sampling.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/errors.hpp"

namespace valsalva::coupling {

using structure::Shape;

namespace {

using CellEdges = std::vector<Edge>;

const CellEdges& edges_of(int count) {
  static const CellEdges line{{0, 1}}, triangle{{0, 1}, {1, 2}, {2, 0}},
      tetrahedron{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
      hexahedron{{0, 1}, {3, 2}, {4, 5}, {7, 6}, {0, 3}, {1, 2},
                 {4, 7}, {5, 6}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};  // four along each direction
  switch (count) {
    case 2:
      return line;
    case 3:
      return triangle;
    case 4:
      return tetrahedron;
    default:
      return hexahedron;
  }
}

double measure_of(const Cell& cell, const Points& x) {
  const auto edge = [&](int i) { return Vec3(x[cell.nodes[i]] - x[cell.nodes[0]]); };
  switch (cell.count) {
    case 2:
      return edge(1).norm();
    case 3:
      return 0.5 * edge(1).cross(edge(2)).norm();
    case 4:
      return edge(1).cross(edge(2)).dot(edge(3)) / 6;
    default: {
      double volume = 0;
      for (const structure::QuadraturePoint& point : quadrature(Shape::hex8, structure::Rule::stiffness)) {
        const structure::ShapeValues shape = evaluate(Shape::hex8, point.at);
        Mat3 jacobian = Mat3::Zero();
        for (int a = 0; a < 8; ++a) jacobian += x[cell.nodes[a]] * shape.gradient.col(a).transpose();
        volume += point.weight * jacobian.determinant();
      }
      return volume;
    }
  }
}

}  // namespace

std::vector<Cell> cells_of(std::span<const Edge> lines, int offset) {
  std::vector<Cell> cells;
  for (const Edge& e : lines) cells.push_back({2, {offset + e[0], offset + e[1]}});
  return cells;
}

std::vector<Cell> cells_of(std::span<const Triangle> triangles, int offset) {
  std::vector<Cell> cells;
  for (const Triangle& t : triangles) cells.push_back({3, {offset + t[0], offset + t[1], offset + t[2]}});
  return cells;
}

std::vector<Cell> cells_of(const structure::SolidMesh& mesh, int offset) {
  // Of tet10: the corners, and the octahedron between them around the diagonal 6-8 (VTK's numbers).
  constexpr std::array<std::array<int, 4>, 8> parts{{{0, 4, 6, 7},
                                                     {4, 1, 5, 8},
                                                     {6, 5, 2, 9},
                                                     {7, 8, 9, 3},
                                                     {6, 8, 4, 5},
                                                     {6, 8, 5, 9},
                                                     {6, 8, 9, 7},
                                                     {6, 8, 7, 4}}};
  const std::vector<Vec3> fine = node_coordinates(Shape::hex27), coarse = node_coordinates(Shape::hex8);
  std::array<int, 27> at_lattice{};
  const auto lattice = [](const Vec3& at) {  // coordinates -1, 0, 1
    return static_cast<int>(std::lround(at.x() + 1 + 3 * (at.y() + 1) + 9 * (at.z() + 1)));
  };
  for (int a = 0; a < 27; ++a) at_lattice[lattice(fine[a])] = a;
  std::vector<Cell> cells;
  for (int e = 0; e < mesh.elements(); ++e) {
    const std::span<const int> nodes = mesh.nodes_of(e);
    const auto add = [&](int count, auto&& local) {
      Cell cell{count, {}};
      for (int i = 0; i < count; ++i) cell.nodes[i] = offset + nodes[local(i)];
      cells.push_back(cell);
    };
    switch (mesh.shapes[e]) {
      case Shape::tet4:
        add(4, [](int i) { return i; });
        break;
      case Shape::hex8:
        add(8, [](int i) { return i; });
        break;
      case Shape::tet10:
        for (const auto& part : parts) add(4, [&](int i) { return part[i]; });
        break;
      case Shape::hex27:
        for (const Vec3& octant : coarse)
          add(8, [&](int i) { return at_lattice[lattice(0.5 * (octant + coarse[i]))]; });
        break;
      default:
        throw InputError(
            "coupling: element {} is a {}; a solid that is immersed has tet4, tet10, hex8, hex27", e,
            name_of(mesh.shapes[e]));
    }
  }
  return cells;
}

std::vector<double> nodal_measures(std::span<const Cell> cells, const Points& x) {
  std::vector<double> measures(x.size(), 0.0);
  for (const Cell& cell : cells) {
    const double each = measure_of(cell, x) / cell.count;
    if (!(each > 0))
      throw InputError("coupling: the element of the nodes {}, {} ... is flat or reversed in the reference",
                       cell.nodes[0], cell.nodes[1]);
    for (int i = 0; i < cell.count; ++i) measures[cell.nodes[i]] += each;
  }
  return measures;
}

std::vector<Edge> edges_of(std::span<const Cell> cells) {
  std::set<Edge> edges;
  for (const Cell& cell : cells)
    for (const Edge& e : edges_of(cell.count)) {
      const int a = cell.nodes[e[0]], b = cell.nodes[e[1]];
      edges.insert({std::min(a, b), std::max(a, b)});
    }
  return {edges.begin(), edges.end()};
}

Sampling::Sampling(std::vector<Cell> cells, const Points& reference, double spacing_mm,
                   const std::vector<std::uint8_t>& left_out)
    : cells_(std::move(cells)), mass_(nodal_measures(cells_, reference)), spacing_(spacing_mm) {
  if (!(spacing_mm > 0))
    throw InputError("coupling: points at a spacing of {} mm; expected a positive one", spacing_mm);
  for (const Cell& cell : cells_) measure_.push_back(measure_of(cell, reference));
  for (std::size_t a = 0; a < mass_.size(); ++a)
    if (mass_[a] == 0 && (left_out.empty() || !left_out[a])) alone_.push_back(static_cast<int>(a));
  locate(reference);
}

const Sampling::Rule& Sampling::rule(int count, const std::array<int, 3>& division) {
  const auto [entry, fresh] =
      rules_.try_emplace({count, division[0], division[1], division[2]}, Rule{0, count, {}});
  Rule& rule = entry->second;
  if (!fresh) return rule;
  const int n = division[0];
  const auto add = [&](std::initializer_list<double> values) {
    rule.shape.insert(rule.shape.end(), values);
    ++rule.points;
  };
  // Simplices: (i + 1/c)/n in all c barycentric coordinates with sum n - 1 of the i: by symmetry every node
  // has the share 1/c.
  if (count == 2) {
    for (int i = 0; i < n; ++i) add({(n - i - 0.5) / n, (i + 0.5) / n});
  } else if (count == 3) {
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        add({(n - 1 - i - j + 1.0 / 3) / n, (i + 1.0 / 3) / n, (j + 1.0 / 3) / n});
  } else if (count == 4) {
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (int k = 0; i + j + k < n; ++k)
          add({(n - 1 - i - j - k + 0.25) / n, (i + 0.25) / n, (j + 0.25) / n, (k + 0.25) / n});
  } else {
    for (int k = 0; k < division[2]; ++k)
      for (int j = 0; j < division[1]; ++j)
        for (int i = 0; i < n; ++i) {
          const Vec3 at(2 * (i + 0.5) / n - 1, 2 * (j + 0.5) / division[1] - 1,
                        2 * (k + 0.5) / division[2] - 1);
          const structure::ShapeValues shape = evaluate(Shape::hex8, at);
          rule.shape.insert(rule.shape.end(), shape.value.begin(), shape.value.end());
          ++rule.points;
        }
  }
  // The dual functions: psi = D G^-1 N, G the mean of N N^T and D that of N over the points.
  const Eigen::Map<const Eigen::MatrixXd> shape(rule.shape.data(), count, rule.points);
  const Eigen::MatrixXd dual = (count * shape * shape.transpose() / rule.points).ldlt().solve(shape);
  rule.shape.insert(rule.shape.end(), dual.data(), dual.data() + dual.size());
  return rule;
}

void Sampling::locate(const Points& x) {
  VALSALVA_ASSERT(x.size() == mass_.size());
  runs_.clear();
  points_.clear();
  constexpr double most = 64;  // an element this long has long failed; the alarm is the caller's
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    const CellEdges& edges = edges_of(cell.count);
    std::array<double, 3> longest{};
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const double length = (x[cell.nodes[edges[e][0]]] - x[cell.nodes[edges[e][1]]]).norm();
      double& entry = longest[cell.count == 8 ? e / 4 : 0];
      entry = std::max(entry, length);
    }
    std::array<int, 3> division{};
    for (int d = 0; d < 3; ++d)
      division[d] =
          std::max(2, static_cast<int>(std::ceil(std::min(longest[d] / spacing_ * (1 - 1e-9), most))));
    const Rule& chosen = rule(cell.count, division);
    runs_.push_back({static_cast<int>(c), &chosen, measure_[c] / chosen.points});
    for (int q = 0; q < chosen.points; ++q) {
      Vec3 at = Vec3::Zero();
      for (int i = 0; i < cell.count; ++i) at += chosen.shape[q * cell.count + i] * x[cell.nodes[i]];
      points_.push_back(at);
    }
  }
  for (int a : alone_) points_.push_back(x[a]);
}

void Sampling::to_points(const Points& nodal_force, Points& at_points) const {
  VALSALVA_ASSERT(nodal_force.size() >= mass_.size());
  at_points.clear();
  for (const Run& run : runs_) {
    const Cell& cell = cells_[run.cell];
    std::array<Vec3, 8> density;
    for (int i = 0; i < cell.count; ++i)
      density[i] = run.share / mass_[cell.nodes[i]] * nodal_force[cell.nodes[i]];
    for (int q = 0; q < run.rule->points; ++q) {
      Vec3 force = Vec3::Zero();
      for (int i = 0; i < cell.count; ++i)
        force += run.rule->shape[(run.rule->points + q) * cell.count + i] * density[i];
      at_points.push_back(force);
    }
  }
  for (int a : alone_) at_points.push_back(nodal_force[a]);
}

void Sampling::to_nodes(const Points& point_velocity, Points& at_nodes) const {
  VALSALVA_ASSERT(point_velocity.size() == points_.size());
  at_nodes.assign(mass_.size(), Vec3::Zero());
  std::size_t first = 0;
  for (const Run& run : runs_) {
    const Cell& cell = cells_[run.cell];
    for (int i = 0; i < cell.count; ++i) {
      Vec3 sum = Vec3::Zero();
      for (int q = 0; q < run.rule->points; ++q)
        sum += run.rule->shape[(run.rule->points + q) * cell.count + i] * point_velocity[first + q];
      at_nodes[cell.nodes[i]] += run.share / mass_[cell.nodes[i]] * sum;
    }
    first += run.rule->points;
  }
  for (int a : alone_) at_nodes[a] = point_velocity[first++];
}

}  // namespace valsalva::coupling
