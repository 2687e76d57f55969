#include "core/errors.hpp"
#include "state/state.hpp"

namespace valsalva::state {
namespace {

template <std::size_t n>
Mesh of_cells(const Points& points, const std::vector<std::array<int, n>>& cells, Cell type) {
  Mesh mesh;
  mesh.points = points;
  mesh.offsets.push_back(0);
  for (const auto& cell : cells) {
    mesh.connectivity.insert(mesh.connectivity.end(), cell.begin(), cell.end());
    mesh.offsets.push_back(static_cast<std::int64_t>(mesh.connectivity.size()));
    mesh.types.push_back(static_cast<std::uint8_t>(type));
  }
  return mesh;
}

template <std::size_t n>
std::vector<std::array<int, n>> cells_of(const Mesh& mesh, Cell type, const std::string& what,
                                         const char* kind) {
  std::vector<std::array<int, n>> cells(mesh.cells());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (mesh.types[c] != static_cast<std::uint8_t>(type) ||
        mesh.offsets[c + 1] - mesh.offsets[c] != static_cast<std::int64_t>(n))
      throw InputError("mesh '{}': cell {} is no {}; only {}s are expected here", what, c, kind, kind);
    for (std::size_t i = 0; i < n; ++i)
      cells[c][i] = static_cast<int>(mesh.connectivity[mesh.offsets[c] + i]);
  }
  return cells;
}

const Array& data_of(const std::map<std::string, Array>& from, const std::string& mesh,
                     const std::string& name, const State& file) {
  const auto found = from.find(name);
  if (found == from.end())
    throw InputError(
        "{}: the mesh '{}' has no data '{}'; expected what docs/architecture.md lists: rerun the stage '{}'",
        file.source, mesh, name, file.stage);
  return found->second;
}

}  // namespace

Mesh Mesh::of_triangles(const Points& points, const std::vector<Triangle>& triangles) {
  return of_cells(points, triangles, Cell::triangle);
}
Mesh Mesh::of_tetrahedra(const Points& points, const std::vector<Tetrahedron>& tetrahedra) {
  return of_cells(points, tetrahedra, Cell::tetra);
}
Mesh Mesh::of_lines(const Points& points, const std::vector<Edge>& edges) {
  return of_cells(points, edges, Cell::line);
}
std::vector<Triangle> Mesh::triangles(const std::string& what) const {
  return cells_of<3>(*this, Cell::triangle, what, "triangle");
}
std::vector<Tetrahedron> Mesh::tetrahedra(const std::string& what) const {
  return cells_of<4>(*this, Cell::tetra, what, "tetrahedron");
}
std::vector<Edge> Mesh::lines(const std::string& what) const {
  return cells_of<2>(*this, Cell::line, what, "line");
}

const Mesh& State::mesh(const std::string& name) const {
  const auto found = meshes.find(name);
  if (found == meshes.end())
    throw InputError("{}: the state of stage '{}' has no mesh '{}'; rerun that stage", source, stage, name);
  return found->second;
}

const Array& State::array(const std::string& name) const {
  const auto found = restart.find(name);
  if (found == restart.end())
    throw InputError("{}: the state of stage '{}' has no entry '{}'; rerun that stage", source, stage, name);
  return found->second;
}

const Array& State::point_data(const std::string& of, const std::string& name) const {
  return data_of(mesh(of).point_data, of, name, *this);
}

const Array& State::cell_data(const std::string& of, const std::string& name) const {
  return data_of(mesh(of).cell_data, of, name, *this);
}

}  // namespace valsalva::state
