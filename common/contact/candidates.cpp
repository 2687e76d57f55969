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

template <std::size_t n>
Box box_around(const Points& x, const std::array<int, n>& nodes, double margin) {
  Box box{x[nodes[0]], x[nodes[0]]};
  for (int node : nodes) {
    box.low = box.low.cwiseMin(x[node]);
    box.high = box.high.cwiseMax(x[node]);
  }
  box.low.array() -= margin;
  box.high.array() += margin;
  return box;
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

double Candidates::largest_distance() const {
  double radius = 0, distance = 0;
  for (const auto& v : mesh_.vertices()) radius = std::max(radius, v.radius_mm);
  for (const auto& e : mesh_.edges()) radius = std::max(radius, e.radius_mm);
  for (const auto& f : mesh_.faces()) radius = std::max(radius, f.radius_mm);
  for (const auto& s : settings_) distance = std::max(distance, s.distance_mm);
  return std::max(2 * radius, distance);
}

void Candidates::update(const Points& x) {
  if (wide_at_.size() != x.size() || largest_motion(x, wide_at_) >= 0.5 * parameters_.wide_skin_mm) {
    update_wide(x);
    update_near(x);
  } else if (largest_motion(x, near_at_) >= 0.5 * parameters_.near_skin_mm) {
    update_near(x);
  }
}

void Candidates::update_wide(const Points& x) {
  ++wide_updates_;
  wide_at_ = x;
  const double skin = parameters_.wide_skin_mm;
  const double margin = 0.5 * (largest_distance() + skin);
  const auto shares_node = [&](const std::array<int, 4>& node, int first) {
    for (int i = 0; i < first; ++i)
      for (int j = first; j < 4; ++j)
        if (mesh_.identity(node[i]) == mesh_.identity(node[j])) return true;
    return false;
  };
  const auto complete = [&](FeaturePair& pair, int body, int other, double radii, double area,
                            double (*distance)(const Points&, const FeaturePair&)) {
    const auto& own = settings(body, other);
    if (!own.active) return false;
    double h = own.distance_mm > 0 ? own.distance_mm : radii;
    if (distance(x, pair) >= h + skin) return false;
    if (mesh_.bodies()[body].group == mesh_.bodies()[other].group)
      h = std::min(h, parameters_.rest_factor * distance(mesh_.reference(), pair));
    pair.contact_distance_mm = h;
    pair.modulus_area_uN = (own.modulus_Pa > 0 ? own.modulus_Pa : parameters_.modulus_Pa) * area;
    return h > 1e-6;
  };

  std::vector<Box> points, faces, edges;
  for (const auto& v : mesh_.vertices()) points.push_back(box_around(x, std::array<int, 1>{v.node}, margin));
  for (const auto& f : mesh_.faces()) faces.push_back(box_around(x, f.node, margin));
  for (const auto& e : mesh_.edges()) edges.push_back(box_around(x, e.node, margin));

  const auto point_pairs = overlapping_boxes(points, faces, false);
  wide_point_ = collect(point_pairs.size(), [&](std::size_t i, FeaturePair& pair) {
    const auto& v = mesh_.vertices()[point_pairs[i][0]];
    const auto& f = mesh_.faces()[point_pairs[i][1]];
    pair.node = {v.node, f.node[0], f.node[1], f.node[2]};
    pair.first = point_pairs[i][0];
    pair.second = point_pairs[i][1];
    return !shares_node(pair.node, 1) &&
           complete(pair, v.body, f.body, v.radius_mm + f.radius_mm, v.area_mm2, distance_of_points);
  });
  const auto edge_pairs = overlapping_boxes(edges, edges, true);
  wide_edge_ = collect(edge_pairs.size(), [&](std::size_t i, FeaturePair& pair) {
    const auto& a = mesh_.edges()[edge_pairs[i][0]];
    const auto& b = mesh_.edges()[edge_pairs[i][1]];
    pair.node = {a.node[0], a.node[1], b.node[0], b.node[1]};
    pair.first = edge_pairs[i][0];
    pair.second = edge_pairs[i][1];
    return !shares_node(pair.node, 2) && complete(pair, a.body, b.body, a.radius_mm + b.radius_mm,
                                                  std::min(a.area_mm2, b.area_mm2), distance_of_edges);
  });
}

void Candidates::update_near(const Points& x) {
  ++near_updates_;
  near_at_ = x;
  const double skin = parameters_.near_skin_mm;
  near_point_ = collect(wide_point_.size(), [&](std::size_t i, FeaturePair& pair) {
    pair = wide_point_[i];
    return distance_of_points(x, pair) < pair.contact_distance_mm + skin;
  });
  near_edge_ = collect(wide_edge_.size(), [&](std::size_t i, FeaturePair& pair) {
    pair = wide_edge_[i];
    return distance_of_edges(x, pair) < pair.contact_distance_mm + skin;
  });
}

}  // namespace valsalva::contact
