#include "structure/element_shapes.hpp"

#include <array>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

constexpr std::array<Edge, 6> tet_edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<Edge, 12> hex_edges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
constexpr std::array<Triangle, 4> tet_faces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
// In the order of hex27's face nodes 20 to 25: -x, +x, -y, +y, -z, +z.
constexpr std::array<std::array<int, 4>, 6> hex_faces{
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
constexpr std::array<std::array<int, 3>, 8> corners{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};

// Where the nodes of a tensor-product element stand: -1, 0 or 1 in each direction.
std::vector<std::array<int, 3>> lattice(Shape shape) {
  std::vector<std::array<int, 3>> at;
  const bool flat = dimension_of(shape) == 2;
  const int first = flat ? 4 : 8;
  for (int a = 0; a < first; ++a)
    at.push_back(flat ? std::array<int, 3>{corners[a][0], corners[a][1], 0} : corners[a]);
  if (shape == Shape::quad4 || shape == Shape::hex8) return at;
  const auto middle = [&](int a, int b) {
    at.push_back({(at[a][0] + at[b][0]) / 2, (at[a][1] + at[b][1]) / 2, (at[a][2] + at[b][2]) / 2});
  };
  if (flat) {
    for (int a = 0; a < 4; ++a) middle(a, (a + 1) % 4);
    at.push_back({0, 0, 0});
    return at;
  }
  for (const Edge& e : hex_edges) middle(e[0], e[1]);
  for (const auto& f : hex_faces) middle(f[0], f[2]);
  at.push_back({0, 0, 0});
  return at;
}

// The one-dimensional Lagrange polynomial that is 1 at `node`, and its slope.
struct Line {
  double value, slope;
};
Line line(bool quadratic, int node, double x) {
  if (!quadratic) return {0.5 * (1 + node * x), 0.5 * node};
  if (node == 0) return {1 - x * x, -2 * x};
  return {0.5 * x * (x + node), x + 0.5 * node};
}

void tensor_product(Shape shape, const Vec3& at, ShapeValues& s) {
  const bool quadratic = shape == Shape::quad9 || shape == Shape::hex27;
  const bool flat = dimension_of(shape) == 2;
  const auto nodes = lattice(shape);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const Line x = line(quadratic, nodes[a][0], at.x()), y = line(quadratic, nodes[a][1], at.y());
    const Line z = flat ? Line{1, 0} : line(quadratic, nodes[a][2], at.z());
    s.value[a] = x.value * y.value * z.value;
    s.gradient.col(a) =
        Vec3(x.slope * y.value * z.value, x.value * y.slope * z.value, x.value * y.value * z.slope);
  }
}

void simplex(Shape shape, const Vec3& at, ShapeValues& s) {
  const int corners = dimension_of(shape) + 1;
  std::array<double, 4> l{1 - at.x() - at.y() - (corners == 4 ? at.z() : 0), at.x(), at.y(), at.z()};
  const std::array<Vec3, 4> slope{Vec3(-1, -1, corners == 4 ? -1 : 0), Vec3::UnitX(), Vec3::UnitY(),
                                  Vec3::UnitZ()};
  if (shape == Shape::tet4 || shape == Shape::triangle3) {
    for (int a = 0; a < corners; ++a) s.value[a] = l[a], s.gradient.col(a) = slope[a];
    return;
  }
  for (int a = 0; a < corners; ++a) {
    s.value[a] = l[a] * (2 * l[a] - 1);
    s.gradient.col(a) = (4 * l[a] - 1) * slope[a];
  }
  const int edges = corners == 4 ? 6 : 3;  // a triangle's are the first three of the tetrahedron
  for (int e = 0; e < edges; ++e) {
    const auto [a, b] = tet_edges[e];
    s.value[corners + e] = 4 * l[a] * l[b];
    s.gradient.col(corners + e) = 4 * (l[a] * slope[b] + l[b] * slope[a]);
  }
}

std::vector<QuadraturePoint> gauss(int order, int dimension) {
  const double two = 1 / std::sqrt(3.0), three = std::sqrt(0.6);
  const std::vector<std::array<double, 2>> line =
      order == 2 ? std::vector<std::array<double, 2>>{{-two, 1}, {two, 1}}
                 : std::vector<std::array<double, 2>>{{-three, 5.0 / 9}, {0, 8.0 / 9}, {three, 5.0 / 9}};
  std::vector<QuadraturePoint> rule;
  for (const auto& z : dimension == 3 ? line : std::vector<std::array<double, 2>>{{0, 1}})
    for (const auto& y : line)
      for (const auto& x : line) rule.push_back({Vec3(x[0], y[0], z[0]), x[1] * y[1] * z[1]});
  return rule;
}

// Points with barycentric coordinates (a, a, a, 1 - 3a), weights as fractions of the volume 1/6.
void add_corners(std::vector<QuadraturePoint>& rule, double a, double weight) {
  const double b = 1 - 3 * a;
  for (const Vec3& at : {Vec3(a, a, a), Vec3(b, a, a), Vec3(a, b, a), Vec3(a, a, b)})
    rule.push_back({at, weight / 6});
}

std::vector<QuadraturePoint> tetrahedron(bool rich) {
  std::vector<QuadraturePoint> rule;
  if (!rich) {
    add_corners(rule, (5 - std::sqrt(5.0)) / 20, 0.25);
    return rule;
  }
  add_corners(rule, 0.31088591926330060980, 0.11268792571801585080);
  add_corners(rule, 0.092735250310891226402, 0.073493043116361949544);
  const double a = 0.045503704125649649492, b = 0.5 - a;
  for (const Vec3& at :
       {Vec3(a, a, b), Vec3(a, b, a), Vec3(b, a, a), Vec3(a, b, b), Vec3(b, a, b), Vec3(b, b, a)})
    rule.push_back({at, 0.042546020777081466438 / 6});
  return rule;
}

// Six points, degree 4 (Strang and Fix 1973).
std::vector<QuadraturePoint> triangle() {
  std::vector<QuadraturePoint> rule;
  const auto add = [&](double a, double weight) {
    const double b = 1 - 2 * a;
    for (const Vec3& at : {Vec3(a, a, 0), Vec3(b, a, 0), Vec3(a, b, 0)}) rule.push_back({at, weight / 2});
  };
  add(0.445948490915965, 0.223381589678011);
  add(0.091576213509771, 0.109951743655322);
  return rule;
}

}  // namespace

int nodes_of(Shape shape) {
  switch (shape) {
    case Shape::triangle3:
      return 3;
    case Shape::quad4:
      return 4;
    case Shape::tet4:
      return 4;
    case Shape::hex8:
      return 8;
    case Shape::triangle6:
      return 6;
    case Shape::tet10:
      return 10;
    case Shape::quad9:
      return 9;
    case Shape::hex27:
      return 27;
  }
  throw InputError("elements: VTK cell type {}; expected 10 (tet4), 24 (tet10), 12 (hex8) or 29 (hex27)",
                   static_cast<int>(shape));
}

int dimension_of(Shape shape) {
  return shape == Shape::triangle3 || shape == Shape::triangle6 || shape == Shape::quad4 ||
                 shape == Shape::quad9
             ? 2
             : 3;
}

std::string name_of(Shape shape) {
  switch (shape) {
    case Shape::triangle3:
      return "tri3";
    case Shape::quad4:
      return "quad4";
    case Shape::tet4:
      return "tet4";
    case Shape::hex8:
      return "hex8";
    case Shape::triangle6:
      return "tri6";
    case Shape::tet10:
      return "tet10";
    case Shape::quad9:
      return "quad9";
    case Shape::hex27:
      return "hex27";
  }
  return "unknown";
}

ShapeValues evaluate(Shape shape, const Vec3& at) {
  ShapeValues s;
  const int n = nodes_of(shape);
  s.value.setZero(n);
  s.gradient.setZero(3, n);
  if (shape == Shape::quad4 || shape == Shape::quad9 || shape == Shape::hex8 || shape == Shape::hex27)
    tensor_product(shape, at, s);
  else
    simplex(shape, at, s);
  return s;
}

std::vector<Vec3> node_coordinates(Shape shape) {
  std::vector<Vec3> at;
  const int n = nodes_of(shape);
  if (shape == Shape::quad4 || shape == Shape::quad9 || shape == Shape::hex8 || shape == Shape::hex27) {
    for (const auto& p : lattice(shape)) at.emplace_back(p[0], p[1], p[2]);
    return at;
  }
  at = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  if (dimension_of(shape) == 3) at.push_back(Vec3::UnitZ());
  const int first = static_cast<int>(at.size());
  for (int e = 0; first + e < n; ++e) at.push_back(0.5 * (at[tet_edges[e][0]] + at[tet_edges[e][1]]));
  return at;
}

std::vector<QuadraturePoint> quadrature(Shape shape, Rule rule) {
  switch (shape) {
    case Shape::tet4:
      return rule == Rule::rich ? tetrahedron(false)
                                : std::vector<QuadraturePoint>{{Vec3(0.25, 0.25, 0.25), 1.0 / 6}};
    case Shape::tet10:
      return tetrahedron(rule == Rule::rich);
    case Shape::hex8:
      return gauss(2, 3);
    case Shape::hex27:
      return gauss(3, 3);
    case Shape::triangle3:
      return {{Vec3(1.0 / 3, 1.0 / 3, 0), 0.5}};
    case Shape::triangle6:
      return triangle();
    case Shape::quad4:
      return gauss(2, 2);
    case Shape::quad9:
      return gauss(3, 2);
  }
  return {};
}

std::vector<LocalFace> faces_of(Shape shape) {
  std::vector<LocalFace> faces;
  const auto middle = [](const auto& edges, int first, int a, int b) {
    for (std::size_t e = 0; e < edges.size(); ++e)
      if ((edges[e][0] == a && edges[e][1] == b) || (edges[e][0] == b && edges[e][1] == a))
        return first + static_cast<int>(e);
    return -1;
  };
  if (shape == Shape::tet4 || shape == Shape::tet10) {
    const bool quadratic = shape == Shape::tet10;
    for (const Triangle& f : tet_faces) {
      LocalFace face{quadratic ? Shape::triangle6 : Shape::triangle3, {f[0], f[1], f[2]}};
      for (int k = 0; quadratic && k < 3; ++k)
        face.nodes.push_back(middle(tet_edges, 4, f[k], f[(k + 1) % 3]));
      faces.push_back(face);
    }
  } else if (shape == Shape::hex8 || shape == Shape::hex27) {
    const bool quadratic = shape == Shape::hex27;
    for (std::size_t i = 0; i < hex_faces.size(); ++i) {
      const auto& f = hex_faces[i];
      LocalFace face{quadratic ? Shape::quad9 : Shape::quad4, {f[0], f[1], f[2], f[3]}};
      for (int k = 0; quadratic && k < 4; ++k)
        face.nodes.push_back(middle(hex_edges, 8, f[k], f[(k + 1) % 4]));
      if (quadratic) face.nodes.push_back(20 + static_cast<int>(i));
      faces.push_back(face);
    }
  }
  return faces;
}

}  // namespace valsalva::structure
