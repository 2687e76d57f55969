#include "assembly/mesh_file.hpp"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <gmsh.h>

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::assembly {
namespace {

namespace fs = std::filesystem;
using structure::Shape;

struct Session {
  Session() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
  }
  ~Session() { gmsh::finalize(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

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
    for (int entity : entities(dimension_of(elements), group)) read_elements(elements, entity);
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

  void read_elements(Elements elements, int entity) {
    if (elements == Elements::lines)
      for (const auto& c : cells(1, 2, entity)) mesh_.lines.push_back({c[0], c[1]});
    if (elements == Elements::triangles) {
      for (const auto& c : cells(2, 3, entity)) mesh_.triangles.push_back({c[0], c[1], c[2]});
      for (const auto& c : cells(3, 4, entity)) {
        mesh_.triangles.push_back({c[0], c[1], c[2]});
        mesh_.triangles.push_back({c[0], c[2], c[3]});
      }
    }
    if (elements == Elements::solids)
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
  if (ending == ".msh" || ending == ".vtk") {
    try {
      const Session session;
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
    throw InputError("{}: unknown ending; expected .msh, .vtk, .stl, .ply, .obj or .off", file.string());
  }
  for (const Vec3& p : mesh.points)
    if (!p.allFinite()) throw InputError("{}: has a coordinate that is not finite", file.string());
  return mesh;
}

}  // namespace valsalva::assembly
