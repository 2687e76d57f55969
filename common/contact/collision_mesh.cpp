#include "contact/collision_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

#include "core/errors.hpp"

namespace valsalva::contact {
namespace {

void check_radius(const std::string& body, double radius_mm) {
  if (!(radius_mm > 0))
    throw InputError("contact body '{}': radius {} mm, expected a positive length", body, radius_mm);
}

}  // namespace

CollisionMesh::CollisionMesh(Points reference)
    : reference_(std::move(reference)), identity_(reference_.size()) {
  std::iota(identity_.begin(), identity_.end(), 0);
}

int CollisionMesh::add_body(const CollisionBody& body) {
  bodies_.push_back(body);
  return static_cast<int>(bodies_.size()) - 1;
}

void CollisionMesh::check_node(const std::string& body, int node) const {
  if (node < 0 || node >= static_cast<int>(reference_.size()))
    throw InputError("contact body '{}': node {} is outside the system of {} nodes", body, node,
                     reference_.size());
}

int CollisionMesh::add_shell(const CollisionBody& body, int offset, const std::vector<Triangle>& triangles,
                             const std::vector<double>& radius_mm) {
  const int index = add_body(body);
  std::map<int, double> vertex_area;
  std::map<std::array<int, 2>, double> edge_area;
  const auto radius = [&](int node) { return radius_mm.at(static_cast<std::size_t>(node - offset)); };
  for (const auto& triangle : triangles) {
    std::array<int, 3> node;
    for (int k = 0; k < 3; ++k) {
      node[k] = offset + triangle[k];
      check_node(body.name, node[k]);
      if (triangle[k] < 0 || triangle[k] >= static_cast<int>(radius_mm.size()))
        throw InputError("contact body '{}': triangle with node {}, expected 0 to {}", body.name, triangle[k],
                         radius_mm.size() - 1);
      check_radius(body.name, radius(node[k]));
    }
    const Vec3 &a = reference_[node[0]], &b = reference_[node[1]], &c = reference_[node[2]];
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) {
      vertex_area[node[k]] += third;
      const int next = node[(k + 1) % 3];
      edge_area[{std::min(node[k], next), std::max(node[k], next)}] += third;
    }
    faces_.push_back({node, index, std::min({radius(node[0]), radius(node[1]), radius(node[2])})});
  }
  share_features(faces_.size() - triangles.size());
  for (const auto& [node, area] : vertex_area) vertices_.push_back({node, index, radius(node), area});
  for (const auto& [edge, area] : edge_area)
    edges_.push_back({edge, index, std::min(radius(edge[0]), radius(edge[1])), area});
  return index;
}

void CollisionMesh::share_features(std::size_t first_face) {
  std::map<std::array<int, 2>, int> on_edge;
  std::map<int, int> at_vertex, missing;  // faces; 1 - faces + sum over its edges of faces - 1
  const auto edge = [](const Face& face, int k) {
    const int a = face.node[k], b = face.node[(k + 1) % 3];
    return std::array<int, 2>{std::min(a, b), std::max(a, b)};
  };
  for (std::size_t f = first_face; f < faces_.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      ++on_edge[edge(faces_[f], k)];
      ++at_vertex[faces_[f].node[k]];
    }
  for (const auto& [node, faces] : at_vertex) missing[node] = 1 - faces;
  for (const auto& [nodes, faces] : on_edge)
    for (int node : nodes) missing[node] += faces - 1;
  for (std::size_t f = first_face; f < faces_.size(); ++f) {
    Face& face = faces_[f];
    for (int k = 0; k < 3; ++k) {
      const double faces = on_edge[edge(face, k)];
      face.edge_share[k] = (1 - faces) / faces;
      face.vertex_share[k] = static_cast<double>(missing[face.node[k]]) / at_vertex[face.node[k]];
    }
  }
}

int CollisionMesh::add_beams(const CollisionBody& body, int offset, const std::vector<Edge>& edges,
                             const std::vector<double>& radius_mm) {
  if (edges.size() != radius_mm.size())
    throw InputError("contact body '{}': {} radii for {} edges", body.name, radius_mm.size(), edges.size());
  const int index = add_body(body);
  std::map<int, std::pair<double, double>> at_vertex;  // radius, area
  for (std::size_t e = 0; e < edges.size(); ++e) {
    check_radius(body.name, radius_mm[e]);
    const std::array<int, 2> node{offset + edges[e][0], offset + edges[e][1]};
    double length = 0;
    for (int n : node) check_node(body.name, n);
    length = (reference_[node[1]] - reference_[node[0]]).norm();
    const double area = 2 * radius_mm[e] * length;
    edges_.push_back({node, index, radius_mm[e], area});
    for (int n : node) {
      auto& [radius, sum] = at_vertex[n];
      radius = std::max(radius, radius_mm[e]);
      sum += 0.5 * area;
    }
  }
  for (const auto& [node, value] : at_vertex) vertices_.push_back({node, index, value.first, value.second});
  return index;
}

void CollisionMesh::identify(int node, int other) {
  check_node("ties", node);
  check_node("ties", other);
  const int keep = std::min(identity_[node], identity_[other]);
  const int drop = std::max(identity_[node], identity_[other]);
  for (int& i : identity_)
    if (i == drop) i = keep;
}

int CollisionMesh::body(const std::string& name) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (bodies_[b].name == name) return static_cast<int>(b);
  throw InputError("there is no contact body '{}'", name);
}

}  // namespace valsalva::contact
