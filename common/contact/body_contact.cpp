#include "contact/body_contact.hpp"

#include <omp.h>

#include <algorithm>

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
void BodyContact::find_active(const Points& x, const std::vector<FeaturePair>& pairs, Distance&& distance,
                              std::size_t first_chunk) const {
  const int chunks = chunks_for(pairs.size());
#pragma omp parallel for schedule(dynamic)
  for (int c = 0; c < chunks; ++c) {
    std::vector<Active>& own = active_[first_chunk + c];
    own.clear();
    const std::size_t end = std::min(pairs.size(), static_cast<std::size_t>(c + 1) * chunk_size);
    for (std::size_t i = static_cast<std::size_t>(c) * chunk_size; i < end; ++i) {
      const FeaturePair& pair = pairs[i];
      const Nearest near = distance(x, pair.node);
      const double d = near.distance, h = pair.contact_distance_mm;
      if (d >= h) continue;
      own.push_back({pair.node, near.weight, near.direction, d, h, pair.modulus_area_uN,
                     normal_pressure(law_, pair.modulus_area_uN, d, h)});
    }
  }
}

void BodyContact::find_active(const Points& x) const {
  if (found_at_ == x) return;
  const auto& points = candidates_.point_triangle();
  const auto& edges = candidates_.edge_edge();
  const std::size_t first = chunks_for(points.size());
  active_.resize(first + chunks_for(edges.size()));
  find_active(x, points, nearest_points, 0);
  find_active(x, edges, nearest_edges, first);
  found_at_ = x;
  report_ = {};
  report_.smallest_distance_mm = candidates_.parameters().near_skin_mm;
  for (const auto& chunk : active_)
    for (const Active& pair : chunk) {
      ++report_.active;
      report_.penetration_mm = std::max(report_.penetration_mm, pair.contact_distance_mm - pair.distance_mm);
      report_.smallest_ratio = std::min(report_.smallest_ratio, pair.distance_mm / pair.contact_distance_mm);
      report_.smallest_distance_mm = std::min(report_.smallest_distance_mm, pair.distance_mm);
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
    for (const auto& chunk : active_)
      for (const Active& pair : chunk)
        for (int k = 0; k < 4; ++k) {
          const int node = pair.node[k];
          if (node >= begin && node < end) force[node] += pair.weight[k] * pair.at.pressure * pair.direction;
        }
  }
}

double BodyContact::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  find_active(now.x);
  scatter(out.force);
  double energy = 0;  // pair by pair: the sum must not depend on how the lists are cut into chunks
  for (const auto& chunk : active_)
    for (const Active& pair : chunk) energy += pair.at.energy;
  return energy;
}

void BodyContact::add_stiffness_bound(const structure::Configuration& now,
                                      structure::StiffnessBound& out) const {
  constexpr double approach = 0.8;
  find_active(now.x);
  for (const auto& chunk : active_)
    for (const Active& pair : chunk) {
      const double d = approach * pair.distance_mm, h = pair.contact_distance_mm;
      const Pressure p = normal_pressure(law_, pair.modulus_area_uN, d, h);
      const double lateral = p.pressure / std::max(d, 1e-3 * h);
      for (int k = 0; k < 4; ++k)
        out.translation[pair.node[k]] += 2 * std::abs(pair.weight[k]) * (p.stiffness + lateral);
    }
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

int BodyContact::limit_velocities(structure::System& system, double dt_s) {
  structure::Configuration& now = system.state;
  candidates_.update(now.x);
  find_active(now.x);
  const double free = candidates_.parameters().near_skin_mm;
  double fastest = 0;
  for (const Vec3& v : now.v) fastest = std::max(fastest, v.squaredNorm());
  if (std::sqrt(fastest) * dt_s <= guard_fraction * std::min(report_.smallest_distance_mm, free)) return 0;
  std::vector<double> room(now.x.size(), free);
  for (const auto& chunk : active_)
    for (const Active& pair : chunk)
      for (int node : pair.node) room[node] = std::min(room[node], pair.distance_mm);
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
