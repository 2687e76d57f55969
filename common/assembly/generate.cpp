#include "assembly/generate.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::assembly {
namespace {

constexpr double rad_per_deg = M_PI / 180;

double between(const std::array<double, 2>& range, double s) {
  return rad_per_deg * (range[0] + s * (range[1] - range[0]));
}

/// Points of the grid, and its sides as groups.
struct Grid {
  std::array<int, 3> count;  // points
  int index(int i, int j, int k) const { return (k * count[1] + j) * count[0] + i; }
  BodyMesh mesh(const Map& map, int dimensions) const {
    BodyMesh out;
    for (int k = 0; k < count[2]; ++k)
      for (int j = 0; j < count[1]; ++j)
        for (int i = 0; i < count[0]; ++i) {
          const std::array<int, 3> at{i, j, k};
          Vec3 s = Vec3::Zero();
          for (int d = 0; d < dimensions; ++d) {
            s[d] = static_cast<double>(at[d]) / (count[d] - 1);
            const std::string direction = std::to_string(d + 1);
            const int node = static_cast<int>(out.points.size());
            if (at[d] == 0) out.groups["start" + direction].push_back(node);
            if (at[d] == count[d] - 1) out.groups["end" + direction].push_back(node);
            out.fields["grid" + direction].push_back(s[d]);
          }
          out.points.push_back(map(s));
        }
    return out;
  }
};

double extent(const BodyMesh& mesh) {
  Vec3 low = mesh.points.front(), high = low;
  for (const Vec3& p : mesh.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

/// Sewn where the map closes upon itself.
BodyMesh sewn(const BodyMesh& mesh, bool sew) {
  return sew ? compacted(merged(mesh, 1e-9 * extent(mesh))) : mesh;
}

int permutation_sign(const std::array<int, 3>& p) {
  return (p[1] - p[0]) * (p[2] - p[0]) * (p[2] - p[1]) > 0 ? 1 : -1;
}

/// Kuhn's six tetrahedra of a cube: one a path from corner 0 to corner 7 along the axes.
std::vector<std::array<Eigen::Vector3i, 4>> kuhn() {
  std::vector<std::array<Eigen::Vector3i, 4>> all;
  for (const std::array<int, 3>& p :
       {std::array{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
    std::array<Eigen::Vector3i, 4> corner;
    corner[0].setZero();
    for (int step = 0; step < 3; ++step) corner[step + 1] = corner[step] + Eigen::Vector3i::Unit(p[step]);
    if (permutation_sign(p) < 0) std::swap(corner[1], corner[2]);
    all.push_back(corner);
  }
  return all;
}

}  // namespace

Frame frame_of(const Vec3& origin, const Vec3& first, const Vec3& second, const std::string& what) {
  Frame frame;
  frame.origin = origin;
  const Vec3 e1 = first.normalized();
  const Vec3 e2 = second - second.dot(e1) * e1;
  if (!(first.norm() > 0) || !(e2.norm() > 1e-6 * second.norm()))
    throw InputError("{}: direction1 and direction2 must not vanish or be parallel", what);
  frame.axes << e1, e2.normalized(), e1.cross(e2.normalized());
  return frame;
}

Map plate_map(const Frame& frame, const Vec3& size, double twist_deg) {
  // Twisted shapes turn about the middle line of the section.
  const Vec3 middle(0, 0.5 * size.y(), 0.5 * size.z());
  return [=](const Vec3& s) {
    Vec3 local = s.cwiseProduct(size);
    if (twist_deg != 0)
      local = middle + Eigen::AngleAxisd(rad_per_deg * twist_deg * s.x(), Vec3::UnitX()) * (local - middle);
    return frame.at(local);
  };
}

Map cylinder_map(const Frame& frame, double radius, std::array<double, 2> angle_deg, double height,
                 double wall) {
  return [=](const Vec3& s) {
    const double a = between(angle_deg, s.x()), r = radius + s.z() * wall;
    return frame.at(Vec3(r * std::cos(a), r * std::sin(a), s.y() * height));
  };
}

Map sphere_map(const Frame& frame, double radius, std::array<double, 2> angle_deg,
               std::array<double, 2> polar_deg, double wall) {
  return [=](const Vec3& s) {
    // From the far polar angle to the near one, so that azimuth x polar points outwards.
    const double a = between(angle_deg, s.x()), p = between({polar_deg[1], polar_deg[0]}, s.y());
    const double r = radius + s.z() * wall;
    return frame.at(r * Vec3(std::sin(p) * std::cos(a), std::sin(p) * std::sin(a), std::cos(p)));
  };
}

Map annulus_map(const Frame& frame, double radius, std::array<double, 2> angle_deg, double width,
                double wall) {
  return [=](const Vec3& s) {
    const double a = between(angle_deg, s.x()), r = radius + s.y() * width;
    return frame.at(Vec3(r * std::cos(a), r * std::sin(a), -s.z() * wall));
  };
}

Map disc_map(const Frame& frame, double radius, double wall) {
  return [=](const Vec3& s) {
    const double a = 2 * s.x() - 1, b = 2 * s.y() - 1;
    return frame.at(
        Vec3(radius * a * std::sqrt(1 - 0.5 * b * b), radius * b * std::sqrt(1 - 0.5 * a * a), s.z() * wall));
  };
}

Map ball_map(const Frame& frame, double radius) {
  return [=](const Vec3& s) {
    const Vec3 at = 2 * s - Vec3::Ones(), square = at.cwiseProduct(at);
    Vec3 out;
    for (int d = 0; d < 3; ++d) {
      const double b = square[(d + 1) % 3], c = square[(d + 2) % 3];
      out[d] = radius * at[d] * std::sqrt(1 - 0.5 * b - 0.5 * c + b * c / 3);
    }
    return frame.at(out);
  };
}

Map corner_map(const Points& corners) {
  return [=](const Vec3& s) {
    Vec3 x = Vec3::Zero();
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const bool far1 = c % 4 == 1 || c % 4 == 2, far2 = c % 4 >= 2, far3 = c >= 4;
      const double third = corners.size() == 4 ? 1 : far3 ? s.z() : 1 - s.z();
      x += (far1 ? s.x() : 1 - s.x()) * (far2 ? s.y() : 1 - s.y()) * third * corners[c];
    }
    return x;
  };
}

Map graded(Map map, const Vec3& ratio) {
  if (ratio == Vec3::Ones()) return map;
  return [=](const Vec3& s) {
    Vec3 t = s;
    for (int d = 0; d < 3; ++d)
      if (ratio[d] != 1) t[d] = (std::pow(ratio[d], s[d]) - 1) / (ratio[d] - 1);
    return map(t);
  };
}

BodyMesh curve(const Map& map, int divisions, bool sew) {
  BodyMesh mesh = Grid{{divisions + 1, 1, 1}}.mesh(map, 1);
  for (int i = 0; i < divisions; ++i) mesh.lines.push_back({i, i + 1});
  return sewn(mesh, sew);
}

BodyMesh sheet(const Map& map, std::array<int, 2> divisions, Pattern pattern, bool sew) {
  const Grid grid{{divisions[0] + 1, divisions[1] + 1, 1}};
  BodyMesh mesh = grid.mesh(map, 2);
  for (int j = 0; j < divisions[1]; ++j)
    for (int i = 0; i < divisions[0]; ++i) {
      const int a = grid.index(i, j, 0), b = grid.index(i + 1, j, 0), c = grid.index(i + 1, j + 1, 0),
                d = grid.index(i, j + 1, 0);
      if (pattern == Pattern::crossed) {
        const int centre = static_cast<int>(mesh.points.size());
        const Vec3 middle((i + 0.5) / divisions[0], (j + 0.5) / divisions[1], 0);
        mesh.points.push_back(map(middle));
        mesh.fields["grid1"].push_back(middle.x());
        mesh.fields["grid2"].push_back(middle.y());
        for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, d}, {d, a}})
          mesh.triangles.push_back({p, q, centre});
        continue;
      }
      const bool rising = pattern == Pattern::right || (pattern == Pattern::alternating && (i + j) % 2 == 0);
      if (rising) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
  return sewn(mesh, sew);
}

BodyMesh block(const Map& map, std::array<int, 3> divisions, structure::Shape shape, bool sew) {
  using structure::Shape;
  const bool quadratic = shape == Shape::tet10 || shape == Shape::hex27;
  const bool hexahedra = shape == Shape::hex8 || shape == Shape::hex27;
  const int fine = quadratic ? 2 : 1;
  const Grid grid{{fine * divisions[0] + 1, fine * divisions[1] + 1, fine * divisions[2] + 1}};
  BodyMesh mesh = grid.mesh(map, 3);
  const std::vector<Vec3> own = structure::node_coordinates(shape);
  const auto tetrahedra = kuhn();
  const auto add = [&](const Eigen::Vector3i& corner, const auto& place) {
    SolidCell cell{shape, {}};
    for (const Vec3& r : own) {
      const Vec3 at = fine * (corner.cast<double>() + place(r));
      cell.nodes.push_back(grid.index(static_cast<int>(std::lround(at.x())),
                                      static_cast<int>(std::lround(at.y())),
                                      static_cast<int>(std::lround(at.z()))));
    }
    mesh.solids.push_back(std::move(cell));
  };
  for (int k = 0; k < divisions[2]; ++k)
    for (int j = 0; j < divisions[1]; ++j)
      for (int i = 0; i < divisions[0]; ++i) {
        const Eigen::Vector3i corner(i, j, k);
        if (hexahedra) {
          add(corner, [](const Vec3& r) { return Vec3(0.5 * (r + Vec3::Ones())); });
          continue;
        }
        for (const auto& t : tetrahedra)
          add(corner, [&](const Vec3& r) {
            return Vec3((1 - r.sum()) * t[0].cast<double>() + r[0] * t[1].cast<double>() +
                        r[1] * t[2].cast<double>() + r[2] * t[3].cast<double>());
          });
      }
  return sewn(mesh, sew);
}

BodyMesh repeated_round(const BodyMesh& mesh, const Frame& frame, int copies) {
  BodyMesh all;
  const int nodes = static_cast<int>(mesh.points.size());
  const Vec3 axis = frame.axes.col(2);
  for (int copy = 0; copy < copies; ++copy) {
    const Eigen::AngleAxisd turn(2 * M_PI * copy / copies, axis);
    const int first = copy * nodes;
    for (const Vec3& x : mesh.points) all.points.push_back(frame.origin + turn * (x - frame.origin));
    for (const Triangle& t : mesh.triangles)
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    for (const Edge& e : mesh.lines) all.lines.push_back({e[0] + first, e[1] + first});
    for (SolidCell cell : mesh.solids) {
      for (int& a : cell.nodes) a += first;
      all.solids.push_back(std::move(cell));
    }
    for (const auto& [name, members] : mesh.groups)
      for (int a : members) {
        all.groups[name].push_back(a + first);
        all.groups[name + "_" + std::to_string(copy + 1)].push_back(a + first);
      }
    for (const auto& [name, values] : mesh.fields)
      all.fields[name].insert(all.fields[name].end(), values.begin(), values.end());
  }
  return sewn(all, true);
}

double bilinear(const std::vector<double>& values, std::array<int, 2> count, double u, double v) {
  const auto cell = [](double t, int n) {
    const int i = std::clamp(static_cast<int>(t * (n - 1)), 0, n - 2);
    return std::pair{i, t * (n - 1) - i};
  };
  const auto [i, a] = cell(u, count[0]);
  const auto [j, b] = cell(v, count[1]);
  const auto at = [&](int p, int q) { return values[q * count[0] + p]; };
  return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) +
         b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

}  // namespace valsalva::assembly
