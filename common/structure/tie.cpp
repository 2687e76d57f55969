#include "structure/tie.hpp"

#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::structure {

TieTerm::TieTerm(std::string name, std::vector<Tie> ties, const System& system)
    : name_(std::move(name)), ties_(std::move(ties)) {
  const int nodes = static_cast<int>(system.nodes());
  for (std::size_t i = 0; i < ties_.size(); ++i) {
    const Tie& t = ties_[i];
    if (t.tissue < 0 || t.tissue >= nodes || t.frame < 0 || t.frame >= nodes || t.tissue == t.frame)
      throw InputError("{}: tie {} joins the nodes {} and {}; expected two different ones below {}", name_, i,
                       t.tissue, t.frame, nodes);
    if (!(t.stiffness_uN_per_mm > 0))
      throw InputError("{}: tie {} has the stiffness {} uN/mm; expected a positive one", name_, i,
                       t.stiffness_uN_per_mm);
    rotation_.push_back(system.rotation_of(t.frame));
  }
}

Vec3 TieTerm::arm(const Configuration& now, std::size_t i) const {
  return rotation_[i] < 0 ? ties_[i].offset : now.rotation[rotation_[i]] * ties_[i].offset;
}

double TieTerm::add_forces(const Configuration& now, Forces& out) const {
  double energy = 0;
  for (std::size_t i = 0; i < ties_.size(); ++i) {
    const Tie& t = ties_[i];
    const Vec3 lever = arm(now, i);
    const Vec3 gap = now.x[t.tissue] - now.x[t.frame] - lever;
    const Vec3 pull = t.stiffness_uN_per_mm * gap;
    out.force[t.tissue] -= pull;
    out.force[t.frame] += pull;
    if (rotation_[i] >= 0) out.moment[rotation_[i]] += lever.cross(pull);
    energy += 0.5 * t.stiffness_uN_per_mm * gap.squaredNorm();
  }
  return energy;
}

void TieTerm::add_stiffness_bound(const Configuration& now, StiffnessBound& out) const {
  // A rotation counts as an arc of 1 mm; the entry of the gap itself (geometric stiffness) is included.
  for (std::size_t i = 0; i < ties_.size(); ++i) {
    const Tie& t = ties_[i];
    const double k = t.stiffness_uN_per_mm;
    const Vec3 lever = arm(now, i);
    const double reach = lever.norm();
    const double gap = (now.x[t.tissue] - now.x[t.frame] - lever).norm();
    const double row = 2 * k + 2 * k * reach;
    out.translation[t.tissue] += row;
    out.translation[t.frame] += row;
    if (rotation_[i] >= 0) out.rotation[rotation_[i]] += 2 * k * reach * (1 + reach + gap);
  }
}

void TieTerm::add_tangent(const Configuration& now, BlockMatrix& out) const {
  for (std::size_t i = 0; i < ties_.size(); ++i) {
    const Tie& t = ties_[i];
    const Mat3 spring = t.stiffness_uN_per_mm * Mat3::Identity();
    out.add(t.tissue, t.tissue, spring);
    out.add(t.frame, t.frame, spring);
    out.add(t.tissue, t.frame, -spring);
    out.add(t.frame, t.tissue, -spring);
    if (rotation_[i] < 0) continue;
    const int turn = out.slot_of_rotation(rotation_[i]);
    const Vec3 lever = arm(now, i);
    const Vec3 pull = t.stiffness_uN_per_mm * (now.x[t.tissue] - now.x[t.frame] - lever);
    const Mat3 l = cross_matrix(lever), kl = t.stiffness_uN_per_mm * l;
    out.add(t.tissue, turn, kl);
    out.add(t.frame, turn, -kl);
    out.add(turn, t.tissue, -kl);
    out.add(turn, t.frame, kl);
    out.add(turn, turn, -kl * l - cross_matrix(pull) * l);
  }
}

double TieTerm::max_gap(const Configuration& now) const {
  double largest = 0;
  for (std::size_t i = 0; i < ties_.size(); ++i)
    largest = std::max(largest, (now.x[ties_[i].tissue] - now.x[ties_[i].frame] - arm(now, i)).norm());
  return largest;
}

std::vector<Tie> ties_in_reference(const Points& tissue_reference, const Points& frame_reference,
                                   const std::vector<Edge>& tissue_and_frame, const Body& tissue,
                                   const Body& frame, double stiffness_uN_per_mm) {
  std::vector<Tie> ties;
  ties.reserve(tissue_and_frame.size());
  for (const auto& [t, f] : tissue_and_frame) {
    if (t < 0 || t >= tissue.count || f < 0 || f >= frame.count)
      throw InputError("ties of '{}' to '{}': the pair ({}, {}) is outside the bodies' {} and {} nodes",
                       tissue.name, frame.name, t, f, tissue.count, frame.count);
    ties.push_back(
        {tissue.offset + t, frame.offset + f, tissue_reference[t] - frame_reference[f], stiffness_uN_per_mm});
  }
  return ties;
}

}  // namespace valsalva::structure
