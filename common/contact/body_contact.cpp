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

std::array<Vec3, 4> places(const Points& x, const std::array<int, 4>& n) {
  return {x[n[0]], x[n[1]], x[n[2]], x[n[3]]};
}

}  // namespace

BodyContact::BodyContact(Candidates candidates, Law law, double slip_share, std::string name)
    : candidates_(std::move(candidates)), law_(law), name_(std::move(name)), friction_(slip_share) {}

void BodyContact::begin_step(const structure::Configuration& now, double) {
  candidates_.update(now.x);
  if (!candidates_.any_friction()) return;
  find_active(now.x);
  std::vector<PairFriction*> pairs;
  for (auto& chunk : active_)
    for (Active& pair : chunk) {
      if (pair.friction.coefficient > 0) pairs.push_back(&pair.friction);
    }
  friction_.accept(pairs, now.x);
}

void BodyContact::find_active(const Points& x, const std::vector<FeaturePair>& pairs, PairKind kind,
                              std::size_t first_chunk) const {
  const int chunks = chunks_for(pairs.size());
#pragma omp parallel for schedule(dynamic)
  for (int c = 0; c < chunks; ++c) {
    std::vector<Active>& own = active_[first_chunk + c];
    own.clear();
    const std::size_t end = std::min(pairs.size(), static_cast<std::size_t>(c + 1) * chunk_size);
    for (std::size_t i = static_cast<std::size_t>(c) * chunk_size; i < end; ++i) {
      const FeaturePair& pair = pairs[i];
      const std::array<Vec3, 4> place = places(x, pair.node);
      const Nearest near = nearest(kind, place);
      const double d = near.distance, h = pair.contact_distance_mm;
      if (d >= h) continue;
      own.push_back({kind,
                     pair.node,
                     near.weight,
                     near.direction,
                     d,
                     h,
                     pair.modulus_area_uN,
                     normal_pressure(law_, pair.modulus_area_uN, d, h),
                     {}});
      const std::size_t whole = own.size() - 1;
      Vec3 push = own.back().at.pressure * near.direction;
      if (pair.even) push += add_parts(kind, pair, place, own);
      if (pair.friction > 0) own[whole].friction = friction_.at(kind, pair, x, near, push);
    }
  }
}

Vec3 BodyContact::add_parts(PairKind kind, const FeaturePair& pair, const std::array<Vec3, 4>& x,
                            std::vector<Active>& own) const {
  const double h = pair.contact_distance_mm;
  Vec3 push = Vec3::Zero();
  const auto add = [&](int point, int a, int b, bool point_first, double share) {
    if (share == 0) return;
    const Nearest near = point_segment(x, point, a, b, point_first);
    if (near.distance >= h) return;
    Pressure at = normal_pressure(law_, pair.modulus_area_uN, near.distance, h);
    at.energy *= share;
    at.pressure *= share;
    at.stiffness *= share;
    push += at.pressure * near.direction;
    own.push_back({kind,
                   pair.node,
                   near.weight,
                   near.direction,
                   near.distance,
                   h,
                   pair.modulus_area_uN,
                   at,
                   {},
                   share,
                   false});
  };
  if (kind == PairKind::point_triangle) {
    const Face& face = candidates_.mesh().faces()[pair.second];
    for (int k = 0; k < 3; ++k) {
      add(0, 1 + k, 1 + (k + 1) % 3, true, face.edge_share[k]);
      add(0, 1 + k, 1 + k, true, face.vertex_share[k]);
    }
    return push;
  }
  for (int k = 0; k < 2; ++k) {
    add(k, 2, 3, true, -0.5);
    add(2 + k, 0, 1, false, -0.5);
    for (int other = 2; other < 4; ++other) add(k, other, other, true, 0.25);
  }
  return push;
}

void BodyContact::find_active(const Points& x) const {
  if (found_at_ == x) return;
  candidates_.update(x);
  const auto& points = candidates_.point_triangle();
  const auto& edges = candidates_.edge_edge();
  const std::size_t first = chunks_for(points.size());
  active_.resize(first + chunks_for(edges.size()));
  find_active(x, points, PairKind::point_triangle, 0);
  find_active(x, edges, PairKind::edge_edge, first);
  found_at_ = x;
  report_ = {};
  report_.smallest_distance_mm = candidates_.parameters().near_skin_mm;
  for (const auto& chunk : active_)
    for (const Active& pair : chunk) {
      if (!pair.whole) continue;
      ++report_.active;
      report_.slipping += pair.friction.slips();
      report_.penetration_mm = std::max(report_.penetration_mm, pair.contact_distance_mm - pair.distance_mm);
      report_.smallest_ratio = std::min(report_.smallest_ratio, pair.distance_mm / pair.contact_distance_mm);
      report_.smallest_distance_mm = std::min(report_.smallest_distance_mm, pair.distance_mm);
    }
}

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
          if (node < begin || node >= end) continue;
          force[node] += pair.weight[k] * pair.at.pressure * pair.direction;
          if (pair.friction.coefficient > 0) force[node] += pair.weight[k] * pair.friction.on_first;
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
  find_active(now.x);
  for (const auto& chunk : active_)
    for (const Active& pair : chunk) {
      const double d = approach * pair.distance_mm, h = pair.contact_distance_mm;
      const Pressure p = normal_pressure(law_, pair.modulus_area_uN, d, h);
      double lateral = p.pressure / std::max(d, 1e-3 * h);
      const double mu = pair.friction.coefficient;
      if (mu > 0) lateral += mu * (p.pressure / pair.friction.range_mm + p.stiffness);
      // What is taken back stiffens only across its direction.
      const double stiffness = pair.share < 0 ? -pair.share * lateral : pair.share * (p.stiffness + lateral);
      for (int k = 0; k < 4; ++k) out.translation[pair.node[k]] += 2 * std::abs(pair.weight[k]) * stiffness;
    }
}

double BodyContact::penetration_mm(const Points& x, const std::string& body, const std::string& other) const {
  const CollisionMesh& mesh = candidates_.mesh();
  const int a = mesh.body(body), b = mesh.body(other);
  const auto wanted = [&](int p, int q) { return (p == a && q == b) || (p == b && q == a); };
  double most = 0;
  const auto check = [&](const FeaturePair& pair, PairKind kind) {
    most = std::max(most, pair.contact_distance_mm - nearest(kind, places(x, pair.node)).distance);
  };
  for (const auto& pair : candidates_.point_triangle())
    if (wanted(mesh.vertices()[pair.first].body, mesh.faces()[pair.second].body))
      check(pair, PairKind::point_triangle);
  for (const auto& pair : candidates_.edge_edge())
    if (wanted(mesh.edges()[pair.first].body, mesh.edges()[pair.second].body))
      check(pair, PairKind::edge_edge);
  return most;
}

Points BodyContact::forces(const Points& x) const {
  find_active(x);
  Points force(x.size(), Vec3::Zero());
  scatter(force);
  return force;
}

double BodyContact::limited(const Points& from, const Points& to, const std::vector<FeaturePair>& pairs,
                            PairKind kind, double share) const {
  const int chunks = chunks_for(pairs.size());
  std::vector<double> least(chunks, share);
#pragma omp parallel for schedule(dynamic)
  for (int c = 0; c < chunks; ++c) {
    const std::size_t end = std::min(pairs.size(), static_cast<std::size_t>(c + 1) * chunk_size);
    for (std::size_t i = static_cast<std::size_t>(c) * chunk_size; i < end; ++i) {
      const std::array<Vec3, 4> x0 = places(from, pairs[i].node), x1 = places(to, pairs[i].node);
      const double distance = nearest(kind, x0).distance, h = pairs[i].contact_distance_mm;
      // Round-off of positions must stay far below the distance: nearly no approach beyond the floor.
      const double stop = std::max(approach * std::min(distance, h), std::min(floor * h, 0.9999 * distance));
      if (distance > 0) least[c] = std::min(least[c], allowed_share(kind, x0, x1, stop));
    }
  }
  for (double own : least) share = std::min(share, own);
  return share;
}

double BodyContact::allowed_motion(const structure::Configuration& now, const Points& to) const {
  const Candidates::Swept pairs = candidates_.along(now.x, to);
  const double share = limited(now.x, to, pairs.point_triangle, PairKind::point_triangle, 1);
  return limited(now.x, to, pairs.edge_edge, PairKind::edge_edge, share);
}

structure::Snapshot BodyContact::save() const {
  return candidates_.any_friction() ? friction_.save() : structure::Snapshot{};
}

void BodyContact::restore(const structure::Snapshot& snapshot) {
  if (!candidates_.any_friction()) return;
  friction_.restore(snapshot, name_);
  found_at_.clear();
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
