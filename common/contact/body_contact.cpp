#include "contact/body_contact.hpp"

#include <omp.h>

#include <algorithm>
#include <limits>

#include "contact/distance.hpp"

namespace valsalva::contact {
namespace {

constexpr int chunk_size = 2048;
constexpr double guard_fraction = 0.25;

int chunks_for(std::size_t pairs) {
  return static_cast<int>((pairs + chunk_size - 1) / chunk_size);
}

Nearest nearest_points(const Points& x, const std::array<int, 4>& n) {
  return point_triangle(x[n[0]], x[n[1]], x[n[2]], x[n[3]]);
}
Nearest nearest_edges(const Points& x, const std::array<int, 4>& n) {
  return edge_edge(x[n[0]], x[n[1]], x[n[2]], x[n[3]]);
}

}  // namespace

BodyContact::BodyContact(Candidates candidates, Law law) : candidates_(std::move(candidates)), law_(law) {}

void BodyContact::begin_step(const structure::Configuration& now, double) {
  candidates_.update(now.x);
}

template <class Distance>
void BodyContact::evaluate(const Points& x, const std::vector<FeaturePair>& pairs, Distance&& distance,
                           int first_chunk) const {
  const int chunks = chunks_for(pairs.size());
#pragma omp parallel for schedule(dynamic)
  for (int c = 0; c < chunks; ++c) {
    Chunk& own = chunks_[first_chunk + c];
    own.active.clear();
    own.energy = 0;
    own.report = {};
    own.report.smallest_distance_mm = std::numeric_limits<double>::infinity();
    const std::size_t end = std::min(pairs.size(), static_cast<std::size_t>(c + 1) * chunk_size);
    for (std::size_t i = static_cast<std::size_t>(c) * chunk_size; i < end; ++i) {
      const FeaturePair& pair = pairs[i];
      const Nearest near = distance(x, pair.node);
      const double d = near.distance, h = pair.contact_distance_mm;
      if (d >= h) continue;
      own.report.smallest_distance_mm = std::min(own.report.smallest_distance_mm, d);
      const Pressure p = normal_pressure(law_, pair.modulus_area_uN, d, h);
      own.energy += p.energy;
      own.active.push_back({pair.node, near.weight, p.pressure * near.direction});
      own.report.penetration_mm = std::max(own.report.penetration_mm, h - d);
      own.report.smallest_ratio = std::min(own.report.smallest_ratio, d / h);
    }
    own.report.active = static_cast<long>(own.active.size());
  }
}

// Every thread adds to its own nodes only, each node's contributions in the order of the pairs.
void BodyContact::scatter(Points& force) const {
  const int nodes = static_cast<int>(force.size());
#pragma omp parallel
  {
    const int threads = omp_get_num_threads(), own = omp_get_thread_num();
    const int begin = static_cast<int>(static_cast<long>(nodes) * own / threads);
    const int end = static_cast<int>(static_cast<long>(nodes) * (own + 1) / threads);
    for (const Chunk& chunk : chunks_)
      for (const Active& active : chunk.active)
        for (int k = 0; k < 4; ++k) {
          const int node = active.node[k];
          if (node >= begin && node < end) force[node] += active.weight[k] * active.force;
        }
  }
}

double BodyContact::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  const auto& points = candidates_.point_triangle();
  const auto& edges = candidates_.edge_edge();
  const int first = chunks_for(points.size());
  chunks_.resize(first + chunks_for(edges.size()));
  evaluate(now.x, points, nearest_points, 0);
  evaluate(now.x, edges, nearest_edges, first);
  scatter(out.force);
  double energy = 0;
  report_ = {};
  report_.smallest_distance_mm = candidates_.parameters().near_skin_mm;
  for (const Chunk& chunk : chunks_) {
    energy += chunk.energy;
    report_.active += chunk.report.active;
    report_.penetration_mm = std::max(report_.penetration_mm, chunk.report.penetration_mm);
    report_.smallest_ratio = std::min(report_.smallest_ratio, chunk.report.smallest_ratio);
    report_.smallest_distance_mm = std::min(report_.smallest_distance_mm, chunk.report.smallest_distance_mm);
  }
  return energy;
}

void BodyContact::add_stiffness_bound(const structure::Configuration& now,
                                      structure::StiffnessBound& out) const {
  constexpr double approach = 0.8;
  const auto add = [&](const FeaturePair& pair, const Nearest& near) {
    // Pairs out of contact may or may not be listed, depending on the list's age: they must not count.
    if (near.distance >= pair.contact_distance_mm) return;
    const double d = approach * near.distance;
    const Pressure p = normal_pressure(law_, pair.modulus_area_uN, d, pair.contact_distance_mm);
    const double lateral = p.pressure / std::max(d, 1e-3 * pair.contact_distance_mm);
    for (int k = 0; k < 4; ++k)
      out.translation[pair.node[k]] += 2 * std::abs(near.weight[k]) * (p.stiffness + lateral);
  };
  for (const auto& pair : candidates_.point_triangle()) add(pair, nearest_points(now.x, pair.node));
  for (const auto& pair : candidates_.edge_edge()) add(pair, nearest_edges(now.x, pair.node));
}

double BodyContact::penetration_mm(const Points& x, const std::string& body, const std::string& other) const {
  const CollisionMesh& mesh = candidates_.mesh();
  const int a = mesh.body(body), b = mesh.body(other);
  const auto wanted = [&](int p, int q) { return (p == a && q == b) || (p == b && q == a); };
  double most = 0;
  for (const auto& pair : candidates_.point_triangle())
    if (wanted(mesh.vertices()[pair.first].body, mesh.faces()[pair.second].body))
      most = std::max(most, pair.contact_distance_mm - nearest_points(x, pair.node).distance);
  for (const auto& pair : candidates_.edge_edge())
    if (wanted(mesh.edges()[pair.first].body, mesh.edges()[pair.second].body))
      most = std::max(most, pair.contact_distance_mm - nearest_edges(x, pair.node).distance);
  return most;
}

int BodyContact::limit_velocities(structure::System& system, double dt_s) const {
  structure::Configuration& now = system.state;
  double fastest = 0;
  for (const Vec3& v : now.v) fastest = std::max(fastest, v.squaredNorm());
  const double floor_mm = std::min(report_.smallest_distance_mm, candidates_.parameters().near_skin_mm);
  if (std::sqrt(fastest) * dt_s <= 0.5 * guard_fraction * floor_mm) return 0;
  std::vector<double> room(now.x.size(), candidates_.parameters().near_skin_mm);
  const auto narrow = [&](const FeaturePair& pair, double distance) {
    if (distance >= pair.contact_distance_mm) return;
    for (int node : pair.node) room[node] = std::min(room[node], distance);
  };
  for (const auto& pair : candidates_.point_triangle())
    narrow(pair, nearest_points(now.x, pair.node).distance);
  for (const auto& pair : candidates_.edge_edge()) narrow(pair, nearest_edges(now.x, pair.node).distance);
  int slowed = 0;
  for (std::size_t i = 0; i < now.v.size(); ++i) {
    const double move = now.v[i].norm() * dt_s, allowed = guard_fraction * room[i];
    if (move <= allowed || system.held(static_cast<int>(i))) continue;
    now.v[i] *= allowed / move;
    ++slowed;
  }
  return slowed;
}

}  // namespace valsalva::contact
