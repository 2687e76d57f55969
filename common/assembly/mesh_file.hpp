// Mesh files: gmsh .msh (2 and 4, ASCII or binary), legacy .vtk, Nastran .bdf, .unv and Medit .mesh through
// gmsh's library; .stl, .ply, .obj, .off surfaces through CGAL (polygons are cut into triangles, equal
// corners merged).
//
// gmsh: lines; triangles and quadrangles, cut into linear triangles at all of their nodes; tet4, tet10, hex8,
// hex27; hex20, made complete; prisms and pyramids, cut into tet4. Other elements are refused. Physical
// groups become groups of nodes; views with nodal data become fields.
#pragma once

#include <filesystem>
#include <string>

#include "assembly/mesh.hpp"

namespace valsalva::assembly {

enum class Elements { triangles, lines, solids };

/// Elements of one kind; group: the physical group that holds them, empty for all. Coordinates times `scale`.
/// InputError names the file and what was found.
BodyMesh read_mesh(const std::filesystem::path& file, Elements elements, const std::string& group,
                   double scale);

}  // namespace valsalva::assembly
