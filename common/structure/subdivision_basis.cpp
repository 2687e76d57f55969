#include "structure/subdivision_basis.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

struct Monomial {
  double factor;
  int u, v, w;
};

// Stam 1998, appendix, times 12: the box spline of a corner (u its own coordinate), of the vertex across an
// edge (u and v those of the edge's corners), and of the vertex behind a corner u, beside the line to v.
constexpr std::array corner_spline{Monomial{6, 4, 0, 0},  Monomial{24, 3, 0, 1}, Monomial{24, 2, 0, 2},
                                   Monomial{8, 1, 0, 3},  Monomial{1, 0, 0, 4},  Monomial{24, 3, 1, 0},
                                   Monomial{60, 2, 1, 1}, Monomial{36, 1, 1, 2}, Monomial{6, 0, 1, 3},
                                   Monomial{24, 2, 2, 0}, Monomial{36, 1, 2, 1}, Monomial{12, 0, 2, 2},
                                   Monomial{8, 1, 3, 0},  Monomial{6, 0, 3, 1},  Monomial{1, 0, 4, 0}};
constexpr std::array across_spline{Monomial{1, 4, 0, 0}, Monomial{2, 3, 0, 1},  Monomial{6, 3, 1, 0},
                                   Monomial{6, 2, 1, 1}, Monomial{12, 2, 2, 0}, Monomial{6, 1, 2, 1},
                                   Monomial{6, 1, 3, 0}, Monomial{2, 0, 3, 1},  Monomial{1, 0, 4, 0}};
constexpr std::array behind_spline{Monomial{1, 4, 0, 0}, Monomial{2, 3, 1, 0}};

double power(double x, int n) {
  double p = 1;
  for (int i = 0; i < n; ++i) p *= x;
  return p;
}

// d^(du+dv+dw)/du^du.. of the monomial.
double derived(const Monomial& m, const std::array<double, 3>& at, const std::array<int, 3>& order) {
  double value = m.factor;
  const std::array<int, 3> exponent{m.u, m.v, m.w};
  for (int k = 0; k < 3; ++k) {
    if (order[k] > exponent[k]) return 0;
    for (int i = 0; i < order[k]; ++i) value *= exponent[k] - i;
    value *= power(at[k], exponent[k] - order[k]);
  }
  return value;
}

using Column = Eigen::Matrix<double, 6, 1>;

// corners: which barycentric coordinate stands for u, v, w of the polynomial.
template <std::size_t count>
Column spline(const std::array<Monomial, count>& terms, const std::array<double, 3>& barycentric,
              const std::array<int, 3>& corners) {
  const std::array<double, 3> at{barycentric[corners[0]], barycentric[corners[1]], barycentric[corners[2]]};
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  // by barycentric coordinate
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  double value = 0;
  for (const Monomial& m : terms) {
    value += derived(m, at, {0, 0, 0});
    for (int i = 0; i < 3; ++i) {
      std::array<int, 3> order{};
      ++order[i];
      first[corners[i]] += derived(m, at, order);
      for (int j = 0; j < 3; ++j) {
        std::array<int, 3> twice = order;
        ++twice[j];
        second(corners[i], corners[j]) += derived(m, at, twice);
      }
    }
  }
  const Eigen::Vector3d r(-1, 1, 0), s(-1, 0, 1);
  Column c;
  c << value, first.dot(r), first.dot(s), r.dot(second * r), s.dot(second * s), r.dot(second * s);
  return c / 12;
}

BasisTable regular_basis(const TriangleRings& t, double r, double s) {
  const std::array<double, 3> at{1 - r - s, r, s};
  BasisTable table = BasisTable::Zero(6, t.vertices);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    const std::vector<int>& ring = t.rings[k];
    table.col(k) += spline(corner_spline, at, {k, next, last});
    // Neighbours of corner k: next, last, across the edge to last, behind (two), across the edge to next.
    table.col(ring[3]) += spline(behind_spline, at, {k, last, next});
    table.col(ring[4]) += spline(behind_spline, at, {k, next, last});
    table.col(ring[5]) += spline(across_spline, at, {k, next, last});
  }
  return table;
}

// A triangle somewhere inside the first one, its vertices as rows of weights of the first one's vertices.
struct Patch {
  TriangleRings triangle;
  Eigen::MatrixXd weights;  // vertices x first vertices
};

// One step of Loop's subdivision: the child at corner `corner`, or the middle one (-1), whose corner k is the
// middle of the edge opposite to corner k.
Patch child_of(const Patch& parent, int corner) {
  const TriangleRings& t = parent.triangle;
  std::map<std::array<int, 2>, int> index;  // of a middle of an edge {a, b}, a < b; {a, a}: of an old vertex
  std::vector<Eigen::RowVectorXd> rows;
  const auto middle = [&](int k, int j) {  // of the edge from corner k to its neighbour j
    const std::vector<int>& ring = t.rings[k];
    const int n = static_cast<int>(ring.size()), at = (j + n) % n;
    const auto [entry, created] =
        index.try_emplace({std::min(k, ring[at]), std::max(k, ring[at])}, static_cast<int>(rows.size()));
    if (created)
      rows.push_back(
          0.375 * (parent.weights.row(k) + parent.weights.row(ring[at])) +
          0.125 * (parent.weights.row(ring[(at + 1) % n]) + parent.weights.row(ring[(at + n - 1) % n])));
    return entry->second;
  };
  const auto old = [&](int k) {
    const auto [entry, created] = index.try_emplace({k, k}, static_cast<int>(rows.size()));
    if (created) {
      const std::vector<int>& ring = t.rings[k];
      const double b = loop_weight(static_cast<int>(ring.size()));
      Eigen::RowVectorXd row = (1 - b * static_cast<double>(ring.size())) * parent.weights.row(k);
      for (int a : ring) row += b * parent.weights.row(a);
      rows.push_back(row);
    }
    return entry->second;
  };
  // Neighbours of the middle of the edge from corner i to j = i + 1, counter-clockwise.
  const auto ring_of_middle = [&](int i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    return std::vector<int>{old(j), middle(j, 0), middle(k, 0), old(i), middle(i, -1), middle(j, 2)};
  };
  std::array<std::vector<int>, 3> rings;
  std::array<int, 3> corners;
  if (corner < 0) {
    for (int k = 0; k < 3; ++k) corners[k] = middle((k + 1) % 3, 0);
    for (int k = 0; k < 3; ++k) rings[k] = ring_of_middle((k + 1) % 3);
  } else {
    const int next = (corner + 1) % 3, last = (corner + 2) % 3;
    corners[corner] = old(corner);
    corners[next] = middle(corner, 0);
    corners[last] = middle(last, 0);
    for (int a = 0; a < static_cast<int>(t.rings[corner].size()); ++a)
      rings[corner].push_back(middle(corner, a));
    rings[next] = ring_of_middle(corner);
    rings[last] = ring_of_middle(last);
  }
  // Corners first, the others in the order of their creation.
  std::vector<int> renumbered(rows.size(), -1);
  for (int k = 0; k < 3; ++k) renumbered[corners[k]] = k;
  int count = 3;
  for (int& a : renumbered)
    if (a < 0) a = count++;
  Patch child;
  child.triangle.vertices = count;
  child.weights.resize(count, parent.weights.cols());
  for (std::size_t a = 0; a < rows.size(); ++a) child.weights.row(renumbered[a]) = rows[a];
  for (int k = 0; k < 3; ++k) {
    std::vector<int>& ring = rings[k];
    for (int& a : ring) a = renumbered[a];
    std::rotate(ring.begin(), std::find(ring.begin(), ring.end(), (k + 1) % 3), ring.end());
    VALSALVA_ASSERT(ring[0] == (k + 1) % 3 && ring[1] == (k + 2) % 3);
  }
  child.triangle.rings = rings;
  return child;
}

}  // namespace

double loop_weight(int valence) {
  const double c = 0.375 + 0.25 * std::cos(2 * M_PI / valence);
  return (0.625 - c * c) / valence;
}

double loop_limit_weight(int valence) {
  return 1 / (valence + 0.375 / loop_weight(valence));
}

BasisTable loop_basis(const TriangleRings& triangle, double r, double s) {
  if (triangle.regular()) return regular_basis(triangle, r, s);
  Patch patch{triangle, Eigen::MatrixXd::Identity(triangle.vertices, triangle.vertices)};
  double first = 1;  // d(child's parameter)/d(ours)
  constexpr int deepest = 40;
  for (int level = 0; !patch.triangle.regular(); ++level) {
    VALSALVA_ASSERT(level < deepest);
    const std::array<double, 3> at{1 - r - s, r, s};
    const auto largest = std::max_element(at.begin(), at.end());
    const int corner = *largest > 0.5 ? static_cast<int>(largest - at.begin()) : -1;
    patch = child_of(patch, corner);
    const double sign = corner < 0 ? -1 : 1;
    r = corner < 0 ? 1 - 2 * r : 2 * r - (corner == 1);
    s = corner < 0 ? 1 - 2 * s : 2 * s - (corner == 2);
    first *= 2 * sign;
  }
  BasisTable table = regular_basis(patch.triangle, r, s) * patch.weights;
  table.middleRows<2>(1) *= first;
  table.bottomRows<3>() *= first * first;
  return table;
}

}  // namespace valsalva::structure
