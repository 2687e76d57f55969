#include "contact/candidates.hpp"

#include <algorithm>

#include "contact/distance.hpp"
#include "core/errors.hpp"

namespace valsalva::contact {
namespace {

constexpr int chunk = 4096;

double distance_of_points(const Points& x, const FeaturePair& p) {
  return point_triangle(x[p.node[0]], x[p.node[1]], x[p.node[2]], x[p.node[3]]).distance;
}
double distance_of_edges(const Points& x, const FeaturePair& p) {
  return edge_edge(x[p.node[0]], x[p.node[1]], x[p.node[2]], x[p.node[3]]).distance;
}

/// Appends make(i) for every i of [0, n) for which it yields something, in the order of i.
template <class Make>
std::vector<FeaturePair> collect(std::size_t n, Make&& make) {
  const int chunks = static_cast<int>((n + chunk - 1) / chunk);
  std::vector<std::vector<FeaturePair>> part(chunks);
#pragma omp parallel for schedule(dynamic)
  for (int c = 0; c < chunks; ++c) {
    const std::size_t end = std::min(n, static_cast<std::size_t>(c + 1) * chunk);
    FeaturePair pair;
    for (std::size_t i = static_cast<std::size_t>(c) * chunk; i < end; ++i)
      if (make(i, pair)) part[c].push_back(pair);
  }
  std::vector<FeaturePair> all;
  std::size_t total = 0;
  for (const auto& p : part) total += p.size();
  all.reserve(total);
  for (const auto& p : part) all.insert(all.end(), p.begin(), p.end());
  return all;
}

double largest_motion(const Points& x, const Points& from) {
  double most = 0;
  for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, (x[i] - from[i]).squaredNorm());
  return std::sqrt(most);
}

const std::array<int, 1> nodes_of(const Vertex& vertex) {
  return {vertex.node};
}
template <class Feature>
const auto& nodes_of(const Feature& feature) {
  return feature.node;
}

/// Boxes around features (on the way from x to `to`, unless null), each with its share of the contact
/// distance and of the skin.
template <class Feature>
std::vector<Box> boxes_around(const Points& x, const Points* to, const std::vector<Feature>& features,
                              const std::vector<int>& chosen, double distance, double skin) {
  std::vector<Box> boxes;
  boxes.reserve(chosen.size());
  for (int i : chosen) {
    const auto& nodes = nodes_of(features[i]);
    Box box{x[nodes[0]], x[nodes[0]]};
    for (int node : nodes) {
      box.low = box.low.cwiseMin(x[node]);
      box.high = box.high.cwiseMax(x[node]);
      if (!to) continue;
      box.low = box.low.cwiseMin((*to)[node]);
      box.high = box.high.cwiseMax((*to)[node]);
    }
    const double margin = (distance > 0 ? 0.5 * distance : features[i].radius_mm) + 0.5 * skin;
    box.low.array() -= margin;
    box.high.array() += margin;
    boxes.push_back(box);
  }
  return boxes;
}

template <class Feature>
std::vector<std::vector<int>> by_body(const std::vector<Feature>& features, std::size_t bodies) {
  std::vector<std::vector<int>> lists(bodies);
  for (std::size_t i = 0; i < features.size(); ++i) lists[features[i].body].push_back(static_cast<int>(i));
  return lists;
}

void append(std::vector<FeaturePair>& all, const std::vector<FeaturePair>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Candidates::Candidates(CollisionMesh mesh, CandidateParameters parameters)
    : mesh_(std::move(mesh)),
      parameters_(parameters),
      settings_(mesh_.bodies().size() * mesh_.bodies().size()) {
  VALSALVA_ASSERT(parameters_.near_skin_mm > 0 && parameters_.wide_skin_mm > parameters_.near_skin_mm);
}

void Candidates::set_pair(const std::string& body, const std::string& other, BodyPairSettings settings) {
  const std::size_t a = mesh_.body(body), b = mesh_.body(other), n = mesh_.bodies().size();
  settings_[a * n + b] = settings_[b * n + a] = settings;
  forget();
}

const BodyPairSettings& Candidates::settings(int body, int other) const {
  return settings_[static_cast<std::size_t>(body) * mesh_.bodies().size() + other];
}

void Candidates::forget() {
  wide_at_.clear();
}

void Candidates::update(const Points& x) {
  if (wide_at_.size() != x.size() || largest_motion(x, wide_at_) >= 0.5 * parameters_.wide_skin_mm) {
    update_wide(x);
    update_near(x);
  } else if (largest_motion(x, near_at_) >= 0.5 * parameters_.near_skin_mm) {
    update_near(x);
  }
}

bool Candidates::shares_node(const std::array<int, 4>& node, int first) const {
  for (int i = 0; i < first; ++i)
    for (int j = first; j < 4; ++j)
      if (mesh_.identity(node[i]) == mesh_.identity(node[j])) return true;
  return false;
}

bool Candidates::complete(const Where& where, int body, int other, double radii, double area,
                          Distance distance, FeaturePair& pair) const {
  const BodyPairSettings& own = settings(body, other);
  double h = own.distance_mm > 0 ? own.distance_mm : radii;
  if (!where.to) {
    pair.wide_distance_mm = distance(where.x, pair);
    if (pair.wide_distance_mm >= h + where.skin) return false;
  }
  if (mesh_.bodies()[body].group == mesh_.bodies()[other].group)
    h = std::min(h, parameters_.rest_factor * distance(mesh_.reference(), pair));
  pair.contact_distance_mm = h;
  pair.modulus_area_uN = (own.modulus_Pa > 0 ? own.modulus_Pa : parameters_.modulus_Pa) * area;
  pair.friction = own.friction;
  pair.second_body = other;
  pair.even = own.even;
  return h > 1e-6;
}

void Candidates::find(const Where& where, std::vector<FeaturePair>& points,
                      std::vector<FeaturePair>& pairs_of_edges) const {
  points.clear();
  pairs_of_edges.clear();
  const int bodies = static_cast<int>(mesh_.bodies().size());
  const auto vertices = by_body(mesh_.vertices(), bodies), edges = by_body(mesh_.edges(), bodies),
             faces = by_body(mesh_.faces(), bodies);
  for (int a = 0; a < bodies; ++a)
    for (int b = a; b < bodies; ++b) {
      if (!settings(a, b).active) continue;
      const double distance = settings(a, b).distance_mm;
      append(points, points_near_faces(where, vertices[a], faces[b], distance));
      if (a != b) append(points, points_near_faces(where, vertices[b], faces[a], distance));
      append(pairs_of_edges, edges_near_edges(where, edges[a], edges[b], distance, a == b));
    }
}

void Candidates::update_wide(const Points& x) {
  ++wide_updates_;
  wide_at_ = x;
  find({x, nullptr, parameters_.wide_skin_mm}, wide_point_, wide_edge_);
}

Candidates::Swept Candidates::along(const Points& from, const Points& to) const {
  const auto holds = [&](const Points& made_at, double skin) {
    return made_at.size() == to.size() && largest_motion(from, made_at) < 0.5 * skin &&
           largest_motion(to, made_at) < 0.5 * skin;
  };
  // The near list is cut from the wide one and holds only while that does.
  if (holds(wide_at_, parameters_.wide_skin_mm)) {
    if (holds(near_at_, parameters_.near_skin_mm)) return {near_point_, near_edge_};
    return {wide_point_, wide_edge_};
  }
  Swept swept;
  find({from, &to, 0}, swept.point_triangle, swept.edge_edge);
  return swept;
}

bool Candidates::any_friction() const {
  return std::any_of(settings_.begin(), settings_.end(),
                     [](const BodyPairSettings& s) { return s.active && s.friction > 0; });
}

std::vector<FeaturePair> Candidates::points_near_faces(const Where& where, const std::vector<int>& vertices,
                                                       const std::vector<int>& faces, double distance) const {
  const auto found =
      overlapping_boxes(boxes_around(where.x, where.to, mesh_.vertices(), vertices, distance, where.skin),
                        boxes_around(where.x, where.to, mesh_.faces(), faces, distance, where.skin), false);
  return collect(found.size(), [&](std::size_t i, FeaturePair& pair) {
    pair.first = vertices[found[i][0]];
    pair.second = faces[found[i][1]];
    const Vertex& v = mesh_.vertices()[pair.first];
    const Face& f = mesh_.faces()[pair.second];
    pair.node = {v.node, f.node[0], f.node[1], f.node[2]};
    return !shares_node(pair.node, 1) &&
           complete(where, v.body, f.body, v.radius_mm + f.radius_mm, v.area_mm2, distance_of_points, pair);
  });
}

std::vector<FeaturePair> Candidates::edges_near_edges(const Where& where, const std::vector<int>& edges,
                                                      const std::vector<int>& others, double distance,
                                                      bool same) const {
  const auto found =
      overlapping_boxes(boxes_around(where.x, where.to, mesh_.edges(), edges, distance, where.skin),
                        boxes_around(where.x, where.to, mesh_.edges(), others, distance, where.skin), same);
  return collect(found.size(), [&](std::size_t i, FeaturePair& pair) {
    pair.first = edges[found[i][0]];
    pair.second = others[found[i][1]];
    const ContactEdge& a = mesh_.edges()[pair.first];
    const ContactEdge& b = mesh_.edges()[pair.second];
    pair.node = {a.node[0], a.node[1], b.node[0], b.node[1]};
    return !shares_node(pair.node, 2) && complete(where, a.body, b.body, a.radius_mm + b.radius_mm,
                                                  std::min(a.area_mm2, b.area_mm2), distance_of_edges, pair);
  });
}

void Candidates::update_near(const Points& x) {
  ++near_updates_;
  near_at_ = x;
  std::vector<double> moved(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) moved[i] = (x[i] - wide_at_[i]).norm();
  // A feature's points move no further than its nodes, so most pairs need no new distance.
  const auto near = [&](const FeaturePair& pair, int first, Distance distance) {
    const double reach = pair.contact_distance_mm + parameters_.near_skin_mm;
    double one = 0, other = 0;
    for (int k = 0; k < 4; ++k)
      (k < first ? one : other) = std::max(k < first ? one : other, moved[pair.node[k]]);
    return pair.wide_distance_mm - one - other < reach && distance(x, pair) < reach;
  };
  near_point_ = collect(wide_point_.size(), [&](std::size_t i, FeaturePair& pair) {
    pair = wide_point_[i];
    return near(pair, 1, distance_of_points);
  });
  near_edge_ = collect(wide_edge_.size(), [&](std::size_t i, FeaturePair& pair) {
    pair = wide_edge_[i];
    return near(pair, 2, distance_of_edges);
  });
}

}  // namespace valsalva::contact
