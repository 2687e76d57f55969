// The part of repair.hpp that works on unconnected triangles; for repair.cpp only.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

/// Welds, drops doubled and degenerate triangles and fins, and appends what it did to `actions`.
/// InputError for bad indices, values that are not finite, and edges that keep three or more triangles.
TriMesh clean_soup(const TriMesh& raw, const std::string& name, std::vector<std::string>& actions);

/// Turns triangles so that neighbours agree, duplicates vertices where two fans touch; says so in `actions`.
/// InputError for a surface with one side only.
TriMesh oriented_soup(const TriMesh& clean, const std::string& name, std::vector<std::string>& actions);

}  // namespace valsalva::geometry
