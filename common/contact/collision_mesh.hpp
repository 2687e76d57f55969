// All bodies that may touch, as vertices, edges and faces of one mesh over the nodes of a structure::System.
//
// Every feature has a radius (half the thickness of a shell, half the side of a strut) and an area (a shell:
// a third of the adjacent triangles, for vertices and edges alike; a strut: length times twice its radius).
// Beams contribute vertices and edges, shells vertices, edges and faces.
// Nodes that are sewn together count as one for adjacency (`identify`).
#pragma once

#include <string>
#include <vector>

#include "core/types.hpp"

namespace valsalva::contact {

struct CollisionBody {
  std::string name;
  int group = 0;  ///< bodies of one group share a reference shape; see body_contact.hpp
};

struct Vertex {
  int node, body;
  double radius_mm, area_mm2;
};
struct ContactEdge {
  std::array<int, 2> node;
  int body;
  double radius_mm, area_mm2;
};
struct Face {
  std::array<int, 3> node;
  int body;
  double radius_mm;
  /// What the neighbours see too, so that edges and vertices of the surface count once: of n faces on an edge
  /// (from node k to the next) this one takes back (n - 1)/n, at a vertex it adds its part of what is missing
  /// then (1/n inside, none on a border).
  std::array<double, 3> edge_share{}, vertex_share{};
};

class CollisionMesh {
 public:
  /// reference: positions of all nodes of the system in the reference shape.
  explicit CollisionMesh(Points reference);

  /// Triangles index the body's own nodes, which are offset, offset + 1, ... in the system. radius_mm: one a
  /// node. Returns the body's index. InputError when an index or a radius is out of range.
  int add_shell(const CollisionBody& body, int offset, const std::vector<Triangle>& triangles,
                const std::vector<double>& radius_mm);
  /// radius_mm: one an edge.
  int add_beams(const CollisionBody& body, int offset, const std::vector<Edge>& edges,
                const std::vector<double>& radius_mm);
  /// The two nodes of the system are sewn together: features that hold one are neighbours of those that hold
  /// the other.
  void identify(int node, int other);
  /// The representative of all nodes sewn to this one.
  int identity(int node) const { return identity_[node]; }

  const std::vector<CollisionBody>& bodies() const { return bodies_; }
  const std::vector<Vertex>& vertices() const { return vertices_; }
  const std::vector<ContactEdge>& edges() const { return edges_; }
  const std::vector<Face>& faces() const { return faces_; }
  const Points& reference() const { return reference_; }
  int body(const std::string& name) const;

 private:
  int add_body(const CollisionBody& body);
  void share_features(std::size_t first_face);
  void check_node(const std::string& body, int node) const;
  Points reference_;
  std::vector<int> identity_;
  std::vector<CollisionBody> bodies_;
  std::vector<Vertex> vertices_;
  std::vector<ContactEdge> edges_;
  std::vector<Face> faces_;
};

}  // namespace valsalva::contact
