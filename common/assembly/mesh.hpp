// The mesh of one body as it comes from a file or a generator: triangles, lines or solid elements over common
// nodes, named groups of nodes and named nodal fields. Lengths mm.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/types.hpp"
#include "structure/element_shapes.hpp"

namespace valsalva::assembly {

struct SolidCell {
  structure::Shape shape;
  std::vector<int> nodes;  ///< VTK's numbering
};

struct BodyMesh {
  Points points;
  std::vector<Triangle> triangles;
  std::vector<Edge> lines;
  std::vector<SolidCell> solids;
  std::map<std::string, std::vector<int>> groups;     ///< node numbers, ascending
  std::map<std::string, std::vector<double>> fields;  ///< one value a node
};

/// Only the nodes that elements use, in their order; groups and fields follow.
BodyMesh compacted(const BodyMesh& mesh);

/// Nodes nearer than the tolerance become one (the first); triangles and lines that lose a side are dropped.
BodyMesh merged(const BodyMesh& mesh, double tolerance_mm);

/// Edges with one triangle: the triangle, and the edge's place in it.
std::vector<std::array<int, 2>> border_edges(const std::vector<Triangle>& triangles);

}  // namespace valsalva::assembly
