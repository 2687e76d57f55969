// The pairs of features that may touch: found by the broad phase, kept in two lists with Verlet skins.
//
// The wide list holds every pair nearer than its contact distance plus the wide skin, the near list is cut
// from it with the near skin; each is renewed once a node has moved by half its skin. Both are sorted by pair
// of bodies and the features' indices, and pairs out of contact add nothing, so that no result depends on
// when they were renewed.
//
// Left out: features that share a node (sewn nodes count as one). Features of one group of bodies (of one
// device, which has one reference shape) get at most `rest_factor` times their distance in the reference
// shape as contact distance, so that nothing is active there.
#pragma once

#include "contact/broad_phase.hpp"
#include "contact/collision_mesh.hpp"

namespace valsalva::contact {

/// What differs between pairs of bodies.
struct BodyPairSettings {
  bool active = true;
  double distance_mm = 0;  ///< contact distance; 0: the sum of the two radii
  double modulus_Pa = 0;   ///< K of the pressure law; 0: the common one
  double friction = 0;     ///< Coulomb's coefficient
  bool even = false;       ///< what neighbouring features see alike counts once
};

struct CandidateParameters {
  double modulus_Pa = 2e5;
  double rest_factor = 0.9;
  double wide_skin_mm = 0.3;
  double near_skin_mm = 0.05;
};

/// Point and triangle, or edge and edge; the nodes in the order of contact::Nearest.
struct FeaturePair {
  std::array<int, 4> node;
  int first, second;           ///< indices into vertices and faces, or edges and edges
  double contact_distance_mm;  ///< h
  double modulus_area_uN;      ///< K A, A the smaller of the two features' areas (the vertex's with a face)
  double friction;             ///< Coulomb's coefficient
  int second_body;             ///< of the second feature
  bool even;
  double wide_distance_mm;  ///< distance when the wide list was made
};

class Candidates {
 public:
  Candidates(CollisionMesh mesh, CandidateParameters parameters);

  /// Bodies by name, in any order. InputError for an unknown body.
  void set_pair(const std::string& body, const std::string& other, BodyPairSettings settings);

  /// Makes the lists valid for these positions.
  void update(const Points& x);
  const std::vector<FeaturePair>& point_triangle() const { return near_point_; }
  const std::vector<FeaturePair>& edge_edge() const { return near_edge_; }
  /// Every pair that may come nearer than its contact distance while nodes move on straight lines: from the
  /// lists when they hold that long, by a broad phase over swept boxes otherwise.
  struct Swept {
    std::vector<FeaturePair> point_triangle, edge_edge;
  };
  Swept along(const Points& from, const Points& to) const;
  bool any_friction() const;
  const CollisionMesh& mesh() const { return mesh_; }
  const CandidateParameters& parameters() const { return parameters_; }
  long wide_updates() const { return wide_updates_; }
  long near_updates() const { return near_updates_; }

 private:
  using Distance = double (*)(const Points&, const FeaturePair&);
  const BodyPairSettings& settings(int body, int other) const;
  bool shares_node(const std::array<int, 4>& node, int first) const;
  /// Where pairs are looked for: near the positions x, or, when there is a `to`, on the way there.
  struct Where {
    const Points& x;
    const Points* to = nullptr;
    double skin = 0;
  };
  /// Fills in what depends on distance and bodies; false when the pair is out of reach.
  bool complete(const Where& where, int body, int other, double radii, double area, Distance distance,
                FeaturePair& pair) const;
  std::vector<FeaturePair> points_near_faces(const Where& where, const std::vector<int>& vertices,
                                             const std::vector<int>& faces, double distance) const;
  std::vector<FeaturePair> edges_near_edges(const Where& where, const std::vector<int>& edges,
                                            const std::vector<int>& others, double distance, bool same) const;
  void find(const Where& where, std::vector<FeaturePair>& points, std::vector<FeaturePair>& edges) const;
  void update_wide(const Points& x);
  void update_near(const Points& x);
  void forget();

  CollisionMesh mesh_;
  CandidateParameters parameters_;
  std::vector<BodyPairSettings> settings_;
  std::vector<FeaturePair> wide_point_, wide_edge_, near_point_, near_edge_;
  Points wide_at_, near_at_;
  long wide_updates_ = 0, near_updates_ = 0;
};

}  // namespace valsalva::contact
