#include "assembly/mesh_file.hpp"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.hpp"
#include "geometry/gmsh_session.hpp"

namespace valsalva::assembly {
namespace {

namespace fs = std::filesystem;
using structure::Shape;

const std::array<std::string, 5> gmsh_endings{".msh", ".vtk", ".bdf", ".unv", ".mesh"};
constexpr std::array known_types{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 15, 16, 17};  // gmsh's numbers

int dimension_of(Elements elements) {
  return elements == Elements::lines ? 1 : elements == Elements::triangles ? 2 : 3;
}

const char* name_of(Elements elements) {
  return elements == Elements::lines       ? "lines"
         : elements == Elements::triangles ? "triangles"
                                           : "solid elements";
}

/// Where gmsh keeps the node that VTK's numbering has at each place, by the reference coordinates.
std::vector<int> order_of(int type, Shape shape) {
  std::string name;
  int dimension, order, nodes, primary;
  std::vector<double> at;
  gmsh::model::mesh::getElementProperties(type, name, dimension, order, nodes, at, primary);
  std::vector<int> order_to;
  for (const Vec3& r : structure::node_coordinates(shape))
    for (int n = 0; n < nodes; ++n)
      if ((Vec3(at[3 * n], at[3 * n + 1], at[3 * n + 2]) - r).norm() < 1e-6) order_to.push_back(n);
  VALSALVA_ASSERT(order_to.size() == static_cast<std::size_t>(nodes));
  return order_to;
}

class GmshReader {
 public:
  GmshReader(const fs::path& file, double scale) : file_(file) {
    gmsh::open(file.string());
    std::vector<std::size_t> tags;
    std::vector<double> at, parameters;
    gmsh::model::mesh::getNodes(tags, at, parameters);
    for (std::size_t i = 0; i < tags.size(); ++i) {
      number_[tags[i]] = static_cast<int>(i);
      mesh_.points.emplace_back(scale * Vec3(at[3 * i], at[3 * i + 1], at[3 * i + 2]));
    }
  }

  BodyMesh read(Elements elements, const std::string& group) {
    read_groups();
    read_fields();
    const std::vector<int> list = entities(dimension_of(elements), group);
    refuse_unknown_elements(dimension_of(elements), list);
    for (int entity : list) read_elements(elements, entity);
    if (mesh_.triangles.empty() && mesh_.lines.empty() && mesh_.solids.empty())
      throw InputError("{}: holds no {}{}; expected a mesh of this kind", file_.string(), name_of(elements),
                       group.empty() ? "" : " in the physical group '" + group + "'");
    return compacted(mesh_);
  }

 private:
  void read_groups() {
    gmsh::vectorpair groups;
    gmsh::model::getPhysicalGroups(groups);
    for (const auto& [dimension, tag] : groups) {
      std::string name;
      gmsh::model::getPhysicalName(dimension, tag, name);
      if (name.empty()) name = std::to_string(tag);
      std::vector<std::size_t> tags;
      std::vector<double> at;
      gmsh::model::mesh::getNodesForPhysicalGroup(dimension, tag, tags, at);
      for (std::size_t t : tags) mesh_.groups[name].push_back(number_.at(t));
    }
  }

  void read_fields() {
    std::vector<int> views;
    gmsh::view::getTags(views);
    for (int view : views) {
      std::string name, type;
      gmsh::option::getString("View[" + std::to_string(gmsh::view::getIndex(view)) + "].Name", name);
      std::vector<std::size_t> tags;
      std::vector<std::vector<double>> values;
      double time;
      int components;
      gmsh::view::getModelData(view, 0, type, tags, values, time, components);
      if (type != "NodeData" || components != 1) continue;
      std::vector<double>& field = mesh_.fields[name];
      field.assign(mesh_.points.size(), std::nan(""));
      for (std::size_t i = 0; i < tags.size(); ++i) field[number_.at(tags[i])] = values[i].at(0);
    }
  }

  std::vector<int> entities(int dimension, const std::string& group) {
    std::vector<int> list;
    if (group.empty()) return {-1};
    std::string known;
    gmsh::vectorpair groups;
    gmsh::model::getPhysicalGroups(groups, dimension);
    for (const auto& [d, tag] : groups) {
      std::string name;
      gmsh::model::getPhysicalName(d, tag, name);
      if (name.empty()) name = std::to_string(tag);
      known += (known.empty() ? "" : ", ") + name;
      if (name == group) gmsh::model::getEntitiesForPhysicalGroup(d, tag, list);
    }
    if (list.empty())
      throw InputError("{}: no physical group '{}' of dimension {}; the file has: {}", file_.string(), group,
                       dimension, known.empty() ? "none" : known);
    return list;
  }

  std::vector<std::vector<int>> cells(int type, int nodes, int entity) {
    std::vector<std::size_t> tags, flat;
    gmsh::model::mesh::getElementsByType(type, tags, flat, entity);
    std::vector<std::vector<int>> all(tags.size());
    for (std::size_t c = 0; c < tags.size(); ++c)
      for (int n = 0; n < nodes; ++n) all[c].push_back(number_.at(flat[c * nodes + n]));
    return all;
  }

  void refuse_unknown_elements(int dimension, const std::vector<int>& list) const {
    for (int entity : list) {
      std::vector<int> types;
      gmsh::model::mesh::getElementTypes(types, dimension, entity);
      for (int type : types) {
        if (std::find(known_types.begin(), known_types.end(), type) != known_types.end()) continue;
        std::string name;
        int d, order, nodes, primary;
        std::vector<double> at;
        gmsh::model::mesh::getElementProperties(type, name, d, order, nodes, at, primary);
        throw InputError(
            "{}: holds elements '{}'; expected lines (2, 3 nodes), triangles (3, 6), quadrangles (4, 8, 9), "
            "tetrahedra (4, 10), hexahedra (8, 20, 27), prisms (6) or pyramids (5)",
            file_.string(), name);
      }
    }
  }

  void read_elements(Elements elements, int entity) {
    if (elements == Elements::lines) read_lines(entity);
    if (elements == Elements::triangles) read_triangles(entity);
    if (elements == Elements::solids) read_solids(entity);
  }

  void read_lines(int entity) {
    for (const auto& c : cells(1, 2, entity)) mesh_.lines.push_back({c[0], c[1]});
    for (const auto& c : cells(8, 3, entity)) {
      mesh_.lines.push_back({c[0], c[2]});
      mesh_.lines.push_back({c[2], c[1]});
    }
  }

  void add_quadrangle(int a, int b, int c, int d) {
    mesh_.triangles.push_back({a, b, c});
    mesh_.triangles.push_back({a, c, d});
  }

  // Quadratic surfaces are cut up at their mid-side nodes.
  void read_triangles(int entity) {
    for (const auto& c : cells(2, 3, entity)) mesh_.triangles.push_back({c[0], c[1], c[2]});
    for (const auto& c : cells(3, 4, entity)) add_quadrangle(c[0], c[1], c[2], c[3]);
    for (const auto& c : cells(9, 6, entity))
      for (const Triangle& t : {Triangle{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
        mesh_.triangles.push_back({c[t[0]], c[t[1]], c[t[2]]});
    for (const auto& c : cells(10, 9, entity))
      for (int k = 0; k < 4; ++k) add_quadrangle(c[k], c[4 + k], c[8], c[4 + (k + 3) % 4]);
    for (const auto& c : cells(16, 8, entity)) {
      for (int k = 0; k < 4; ++k) mesh_.triangles.push_back({c[k], c[4 + k], c[4 + (k + 3) % 4]});
      add_quadrangle(c[4], c[5], c[6], c[7]);
    }
  }

  void read_solids(int entity) {
    for (const auto& [type, shape] :
         {std::pair{4, Shape::tet4}, {11, Shape::tet10}, {5, Shape::hex8}, {12, Shape::hex27}}) {
      const auto found = cells(type, structure::nodes_of(shape), entity);
      if (found.empty()) continue;
      const std::vector<int> order = order_of(type, shape);
      for (const auto& c : found) {
        SolidCell cell{shape, {}};
        for (int n : order) cell.nodes.push_back(c[n]);
        mesh_.solids.push_back(std::move(cell));
      }
    }
    read_hexahedra_of_20_nodes(entity);
    for (const auto& c : cells(6, 6, entity)) add_prism({c[0], c[1], c[2], c[3], c[4], c[5]});
    for (const auto& c : cells(7, 5, entity)) {
      // The diagonal of the base from its lowest node, as in a neighbour that is cut up too.
      const int first = static_cast<int>(std::min_element(c.begin(), c.begin() + 4) - c.begin());
      const int a = c[first], b = c[(first + 1) % 4], d = c[(first + 2) % 4], e = c[(first + 3) % 4];
      mesh_.solids.push_back({Shape::tet4, {a, b, d, c[4]}});
      mesh_.solids.push_back({Shape::tet4, {a, d, e, c[4]}});
    }
  }

  /// Three tetrahedra, the diagonals of the sides from the lowest of their nodes (Dompierre and others 1999).
  void add_prism(const std::array<int, 6>& given) {
    constexpr int turned[6][6] = {{0, 1, 2, 3, 4, 5}, {1, 2, 0, 4, 5, 3}, {2, 0, 1, 5, 3, 4},
                                  {3, 5, 4, 0, 2, 1}, {4, 3, 5, 1, 0, 2}, {5, 4, 3, 2, 1, 0}};
    const int lowest = static_cast<int>(std::min_element(given.begin(), given.end()) - given.begin());
    std::array<int, 6> v;
    for (int k = 0; k < 6; ++k) v[k] = given[turned[lowest][k]];
    if (std::min(v[1], v[5]) < std::min(v[2], v[4])) {
      mesh_.solids.push_back({Shape::tet4, {v[0], v[1], v[2], v[5]}});
      mesh_.solids.push_back({Shape::tet4, {v[0], v[1], v[5], v[4]}});
    } else {
      mesh_.solids.push_back({Shape::tet4, {v[0], v[1], v[2], v[4]}});
      mesh_.solids.push_back({Shape::tet4, {v[0], v[4], v[2], v[5]}});
    }
    mesh_.solids.push_back({Shape::tet4, {v[0], v[4], v[5], v[3]}});
  }

  // Made complete: the missing middles of faces and element lie where the 20 nodes put them.
  void read_hexahedra_of_20_nodes(int entity) {
    const auto found = cells(17, 20, entity);
    if (found.empty()) return;
    const std::vector<Vec3> own = structure::node_coordinates(Shape::hex27), gmsh20 = coordinates_of(17);
    std::map<std::vector<int>, int> middle;  // of a face, by its sorted corners
    for (const auto& c : found) {
      SolidCell cell{Shape::hex27, {}};
      for (const Vec3& r : own) {
        const auto same =
            std::find_if(gmsh20.begin(), gmsh20.end(), [&](const Vec3& q) { return (q - r).norm() < 1e-6; });
        if (same != gmsh20.end()) {
          cell.nodes.push_back(c[same - gmsh20.begin()]);
          continue;
        }
        std::vector<int> corners;
        Vec3 x = Vec3::Zero();
        for (int n = 0; n < 20; ++n) {
          x += serendipity(gmsh20[n], r) * mesh_.points[c[n]];
          const bool corner = gmsh20[n].cwiseAbs().minCoeff() > 0.5;
          if (corner && ((gmsh20[n] - r).cwiseProduct(r).cwiseAbs().maxCoeff() < 1e-6 || r.isZero()))
            corners.push_back(c[n]);
        }
        std::sort(corners.begin(), corners.end());
        const auto [entry, fresh] = middle.try_emplace(corners, static_cast<int>(mesh_.points.size()));
        if (fresh) {
          mesh_.points.push_back(x);
          add_to_groups(corners, entry->second);
        }
        cell.nodes.push_back(entry->second);
      }
      mesh_.solids.push_back(std::move(cell));
    }
    for (auto& [name, field] : mesh_.fields) field.resize(mesh_.points.size(), std::nan(""));
  }

  /// A node between others belongs to the groups that hold all of them.
  void add_to_groups(const std::vector<int>& around, int node) {
    for (auto& group : mesh_.groups) {
      std::vector<int>& nodes = group.second;
      const auto holds = [&](int a) { return std::find(nodes.begin(), nodes.end(), a) != nodes.end(); };
      if (std::all_of(around.begin(), around.end(), holds)) nodes.push_back(node);
    }
  }

  static std::vector<Vec3> coordinates_of(int type) {
    std::string name;
    int dimension, order, nodes, primary;
    std::vector<double> at;
    gmsh::model::mesh::getElementProperties(type, name, dimension, order, nodes, at, primary);
    std::vector<Vec3> all;
    for (int n = 0; n < nodes; ++n) all.emplace_back(at[3 * n], at[3 * n + 1], at[3 * n + 2]);
    return all;
  }

  /// Shape function of the 20-node hexahedron's node at `node`, at r.
  static double serendipity(const Vec3& node, const Vec3& r) {
    double product = 1;
    for (int d = 0; d < 3; ++d)
      product *= std::abs(node[d]) < 0.5 ? 1 - r[d] * r[d] : 0.5 * (1 + r[d] * node[d]);
    const bool corner = node.cwiseAbs().minCoeff() > 0.5;
    return corner ? product * (node.dot(r) - 2) : product;
  }

  fs::path file_;
  BodyMesh mesh_;
  std::map<std::size_t, int> number_;
};

BodyMesh read_surface(const fs::path& file, double scale) {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  if (!CGAL::IO::read_polygon_soup(file.string(), points, polygons) || polygons.empty())
    throw InputError("{}: cannot be read as a surface; is it cut short, or of another format?",
                     file.string());
  BodyMesh mesh;
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const Point& p : points) {
    mesh.points.emplace_back(scale * Vec3(p.x(), p.y(), p.z()));
    low = low.cwiseMin(mesh.points.back());
    high = high.cwiseMax(mesh.points.back());
  }
  for (const auto& polygon : polygons)
    for (std::size_t n = 2; n < polygon.size(); ++n)
      mesh.triangles.push_back({int(polygon[0]), int(polygon[n - 1]), int(polygon[n])});
  return compacted(merged(mesh, 1e-7 * (high - low).norm()));
}

}  // namespace

BodyMesh read_mesh(const fs::path& file, Elements elements, const std::string& group, double scale) {
  if (!fs::is_regular_file(file))
    throw InputError("{}: no such mesh file; paths start at the case file's folder", file.string());
  const std::string ending = file.extension().string();
  BodyMesh mesh;
  if (std::find(gmsh_endings.begin(), gmsh_endings.end(), ending) != gmsh_endings.end()) {
    try {
      const geometry::GmshSession session;
      mesh = GmshReader(file, scale).read(elements, group);
    } catch (const Error&) {
      throw;
    } catch (const std::exception& failure) {
      throw InputError("{}: gmsh cannot read it: {}", file.string(), failure.what());
    }
  } else if (ending == ".stl" || ending == ".ply" || ending == ".obj" || ending == ".off") {
    if (elements != Elements::triangles)
      throw InputError("{}: a surface file has triangles, expected {}", file.string(), name_of(elements));
    if (!group.empty())
      throw InputError("{}: a surface file has no groups; found group '{}', expected none", file.string(),
                       group);
    mesh = read_surface(file, scale);
  } else {
    throw InputError("{}: unknown ending; expected .msh, .vtk, .bdf, .unv, .mesh, .stl, .ply, .obj or .off",
                     file.string());
  }
  for (const Vec3& p : mesh.points)
    if (!p.allFinite()) throw InputError("{}: has a coordinate that is not finite", file.string());
  return mesh;
}

}  // namespace valsalva::assembly
