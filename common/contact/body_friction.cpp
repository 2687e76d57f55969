#include "contact/body_friction.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::contact {
namespace {

std::array<Vec3, 4> places(const Points& x, const std::array<int, 4>& n) {
  return {x[n[0]], x[n[1]], x[n[2]], x[n[3]]};
}

/// The normal of both features, of any length; not unique, hence nought, for parallel edges.
Vec3 common_normal(PairKind kind, const std::array<Vec3, 4>& x) {
  const bool edges = kind == PairKind::edge_edge;
  const Vec3 a = edges ? Vec3(x[1] - x[0]) : Vec3(x[2] - x[1]),
             b = edges ? Vec3(x[3] - x[2]) : Vec3(x[3] - x[1]);
  const Vec3 across = a.cross(b);
  return across.norm() > 1e-3 * a.norm() * b.norm() ? across : Vec3(Vec3::Zero());
}

bool pushes_along(const Vec3& normal, const Vec3& n) {
  constexpr double cosine = 0.3;  // less in flat layers only where pairs hardly press
  return std::abs(normal.dot(n)) > cosine * normal.norm();
}

/// Towards n.
Vec3 unit(const Vec3& normal, const Vec3& n) {
  return normal.dot(n) < 0 ? Vec3(-normal.normalized()) : normal.normalized();
}

Vec3 traction(const PairFriction& f) {
  return -f.coefficient * f.pressing_uN / f.range_mm * f.tether;
}

}  // namespace

Friction::Friction(double slip_share) : slip_share_(slip_share) {
  if (!(slip_share > 0 && slip_share <= 1))
    throw InputError("contact friction: range of stick {} of the contact distance; expected above 0, up to 1",
                     slip_share);
}

PairFriction Friction::at(PairKind kind, const FeaturePair& pair, const Points& x, const Nearest& near,
                          const Vec3& normal_force_uN) const {
  const std::array<Vec3, 4> now = places(x, pair.node);
  PairFriction f;
  f.key = {static_cast<int>(kind), pair.first, pair.second};
  f.other_body = pair.second_body;
  f.coefficient = pair.friction;
  f.range_mm = slip_share_ * pair.contact_distance_mm;
  const Vec3 normal = common_normal(kind, now);
  const bool along = pushes_along(normal, near.direction);
  f.normal = along ? unit(normal, near.direction) : near.direction;
  f.pressing_uN = std::max(0.0, normal_force_uN.dot(f.normal));
  const auto own = tethers_.find(f.key);
  if (own == tethers_.end()) return f;
  f.known = true;
  const std::array<Vec3, 4> then = places(accepted_, pair.node);
  Vec3 gap = Vec3::Zero(), gap_then = Vec3::Zero();
  for (int k = 0; k < 4; ++k) {
    gap += near.weight[k] * now[k];
    gap_then += near.weight[k] * then[k];
  }
  const Vec3 direction_then = nearest(kind, then).direction;
  Vec3 normal_then = along ? common_normal(kind, then) : direction_then;
  normal_then = normal_then.isZero() ? direction_then : unit(normal_then, direction_then);
  const auto turn = Eigen::Quaterniond::FromTwoVectors(normal_then, f.normal);
  const Vec3 tether = turn * own->second + (gap - turn * gap_then);
  f.tether = tether - tether.dot(f.normal) * f.normal;
  f.way_mm = f.tether.norm();
  if (f.way_mm > f.range_mm) f.tether *= f.range_mm / f.way_mm;
  f.on_first = traction(f);
  return f;
}

void Friction::accept(const std::vector<PairFriction*>& pairs, const Points& x) {
  // What the pairs of one feature with one body have, in units of the range, weighted by their forces.
  struct Share {
    Vec3 tether = Vec3::Zero();
    double force = 0;
  };
  std::map<std::array<int, 3>, Share> of_feature;
  const auto feature = [](const PairFriction& f) -> std::array<int, 3> {
    return {f.key[0], f.key[1], f.other_body};
  };
  for (const PairFriction* pair : pairs) {
    const PairFriction& f = *pair;
    if (!f.known) continue;
    if (f.slips()) work_ += f.coefficient * f.pressing_uN * (f.way_mm - f.range_mm);
    Share& share = of_feature[feature(f)];
    share.tether += f.pressing_uN / f.range_mm * f.tether;
    share.force += f.pressing_uN;
  }
  tethers_.clear();
  for (PairFriction* pair : pairs) {
    PairFriction& f = *pair;
    if (!f.known) {
      const auto found = of_feature.find(feature(f));
      if (found != of_feature.end() && found->second.force > 0)
        f.tether = f.range_mm / found->second.force * found->second.tether;
      f.on_first = traction(f);
      f.known = true;
    }
    f.way_mm = f.tether.norm();
    tethers_[f.key] = f.tether;
  }
  accepted_ = x;
}

structure::Snapshot Friction::save() const {
  structure::Snapshot s;
  std::vector<double>&keys = s["friction_pairs"], &tethers = s["friction_tethers_mm"],
  &positions = s["friction_positions_mm"];
  for (const auto& [key, tether] : tethers_) {
    for (int k : key) keys.push_back(k);
    tethers.insert(tethers.end(), {tether[0], tether[1], tether[2]});
  }
  for (const Vec3& p : accepted_) positions.insert(positions.end(), {p[0], p[1], p[2]});
  s["friction_work_nJ"] = {work_};
  return s;
}

void Friction::restore(const structure::Snapshot& snapshot, const std::string& owner) {
  static const std::vector<double> none;
  const auto entry = [&](const char* name) -> const std::vector<double>& {  // what is empty is not stored
    const auto found = snapshot.find(name);
    return found == snapshot.end() ? none : found->second;
  };
  const std::vector<double>&keys = entry("friction_pairs"), &tethers = entry("friction_tethers_mm"),
        &positions = entry("friction_positions_mm"), &work = entry("friction_work_nJ");
  if (keys.size() != tethers.size() || keys.size() % 3 || positions.size() % 3 || work.size() != 1)
    throw InputError("{}: the state holds no history of friction; it was written with another case", owner);
  tethers_.clear();
  for (std::size_t i = 0; i < keys.size(); i += 3)
    tethers_[{static_cast<int>(keys[i]), static_cast<int>(keys[i + 1]), static_cast<int>(keys[i + 2])}] =
        Vec3(tethers[i], tethers[i + 1], tethers[i + 2]);
  accepted_.clear();
  for (std::size_t i = 0; i < positions.size(); i += 3)
    accepted_.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
  work_ = work[0];
}

}  // namespace valsalva::contact
