#include "structure/subdivision_topology.hpp"

#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

struct HalfEdge {
  int triangle, corner;  // from the corner to the next one
};

std::map<Edge, HalfEdge> half_edges(int nodes, const std::vector<Triangle>& triangles) {
  std::map<Edge, HalfEdge> edges;
  std::map<Edge, int> sides;
  for (int e = 0; e < static_cast<int>(triangles.size()); ++e) {
    const Triangle& t = triangles[e];
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (a < 0 || a >= nodes)
        throw InputError("shell: triangle {} refers to node {}; the mesh has {} nodes", e, a, nodes);
      if (a == b) throw InputError("shell: triangle {} has node {} twice", e, a);
      if (++sides[{std::min(a, b), std::max(a, b)}] > 2)
        throw InputError(
            "shell: edge {}-{} belongs to more than two triangles ({} is the third); expected at most two: "
            "the "
            "mesh is not manifold",
            std::min(a, b), std::max(a, b), e);
      if (!edges.try_emplace({a, b}, HalfEdge{e, k}).second)
        throw InputError(
            "shell: triangles {} and {} at edge {}-{} are turned against each other; expected one "
            "orientation",
            edges.at({a, b}).triangle, e, a, b);
    }
  }
  return edges;
}

class Builder {
 public:
  Builder(int nodes, const std::vector<Triangle>& triangles, const EdgeConditions& conditions)
      : edges_(half_edges(nodes, triangles)) {
    t_.nodes = nodes;
    t_.triangles = triangles;
    t_.rings.resize(nodes);
    t_.border_of.assign(nodes, {-1, -1});
    find_border(conditions);
    for (int g = 0; g < static_cast<int>(t_.border.size()); ++g) {
      const BorderEdge& edge = t_.border[g];
      t_.ghosts.push_back(
          {{edge.a, edge.b, edge.inner}, {g, t_.border_of[edge.a][0], t_.border_of[edge.b][1]}});
    }
    find_rings();
  }
  SubdivisionTopology take() { return std::move(t_); }

 private:
  void find_border(const EdgeConditions& conditions) {
    for (const auto& [edge, half] : edges_) {
      if (edges_.count({edge[1], edge[0]})) continue;
      BorderEdge border{
          edge[0], edge[1], t_.triangles[half.triangle][(half.corner + 2) % 3], half.triangle, {}};
      const auto found = conditions.find({std::min(edge[0], edge[1]), std::max(edge[0], edge[1])});
      if (found != conditions.end()) border.condition = found->second;
      if (border.condition.support == EdgeSupport::symmetry) {
        if (!(border.condition.normal.norm() > 0))
          throw InputError("shell: symmetry at edge {}-{} has no plane; give its normal", edge[0], edge[1]);
        border.condition.normal.normalize();
      }
      for (const auto [node, side] : {std::pair{border.b, 0}, std::pair{border.a, 1}}) {
        int& slot = t_.border_of[node][side];
        if (slot >= 0)
          throw InputError("shell: two pieces of the surface touch in node {}; give each its own node", node);
        slot = static_cast<int>(t_.border.size());
      }
      t_.border.push_back(border);
    }
    for (const auto& [edge, condition] : conditions) {
      const bool known = edges_.count(edge) || edges_.count({edge[1], edge[0]});
      if (edge[0] > edge[1] || !known || (edges_.count(edge) && edges_.count({edge[1], edge[0]})))
        throw InputError(
            "shell: the support of edge {}-{} is not on the border of the mesh; expected border edges",
            edge[0], edge[1]);
    }
  }

  // Third corner of the triangle left of a -> b.
  int left_of(int a, int b) const {
    const HalfEdge& half = edges_.at({a, b});
    return t_.triangles[half.triangle][(half.corner + 2) % 3];
  }

  void find_rings() {
    std::vector<int> first(t_.nodes, -1), count(t_.nodes, 0);
    for (const Triangle& t : t_.triangles)
      for (int k = 0; k < 3; ++k) {
        ++count[t[k]];
        if (first[t[k]] < 0) first[t[k]] = t[(k + 1) % 3];
      }
    for (int v = 0; v < t_.nodes; ++v) {
      if (count[v] == 0) throw InputError("shell: node {} belongs to no triangle; remove it", v);
      const bool at_border = t_.border_of[v][1] >= 0;
      std::vector<int>& ring = t_.rings[v];
      ring.push_back(at_border ? t_.border[t_.border_of[v][1]].b : first[v]);
      int passed = 0;
      while (edges_.count({v, ring.back()}) && passed < count[v]) {
        ring.push_back(left_of(v, ring.back()));
        ++passed;
      }
      if (passed != count[v])
        throw InputError("shell: two pieces of the surface touch in node {}; give each its own node", v);
      if (!at_border)
        ring.pop_back();  // came round
      else
        close_ring(v, count[v]);
    }
  }

  void close_ring(int v, int triangles) {
    const int before = t_.border_of[v][0], after = t_.border_of[v][1];
    std::vector<int>& ring = t_.rings[v];
    const std::vector<int> own = ring;
    ring.push_back(t_.nodes + before);
    for (int k = 0; k < 3 - triangles; ++k) {
      // One triangle: opposite to the next and to the previous border node; two: opposite to the middle.
      ring.push_back(t_.vertices());
      t_.ghosts.push_back({{v, v, own[triangles == 1 ? k : 1]}, {before, after, -1}});
    }
    ring.push_back(t_.nodes + after);
  }

  std::map<Edge, HalfEdge> edges_;
  SubdivisionTopology t_;
};

}  // namespace

bool SubdivisionTopology::supported(int node) const {
  for (int edge : border_of[node])
    if (edge >= 0 && (border[edge].condition.support == EdgeSupport::hinged ||
                      border[edge].condition.support == EdgeSupport::clamped))
      return true;
  return false;
}

SubdivisionTopology subdivision_topology(int nodes, const std::vector<Triangle>& triangles,
                                         const EdgeConditions& conditions) {
  return Builder(nodes, triangles, conditions).take();
}

}  // namespace valsalva::structure
