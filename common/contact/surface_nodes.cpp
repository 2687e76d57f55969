#include "contact/surface_nodes.hpp"

#include "core/errors.hpp"

namespace valsalva::contact {

Tethers::Tethers(std::size_t count, double friction, double tangent_Pa_per_mm)
    : friction_(friction), tangent_(tangent_Pa_per_mm), engaged_(count, 0.0), anchor_(count, Vec3::Zero()) {}

void Tethers::advance(std::size_t i, const Vec3& position, const Vec3& normal, double normal_force_uN,
                      double area_mm2) {
  if (friction_ <= 0) return;
  if (normal_force_uN <= 0) {
    engaged_[i] = 0;
    anchor_[i].setZero();
    return;
  }
  if (!engaged(i)) {
    engaged_[i] = 1;
    anchor_[i] = position;
    return;
  }
  const Vec3 offset = position - anchor_[i];
  const Vec3 slip = offset - offset.dot(normal) * normal;
  const double reach = friction_ * normal_force_uN / stiffness(area_mm2), length = slip.norm();
  if (length > reach) anchor_[i] += (1 - reach / length) * slip;
}

Vec3 Tethers::force(std::size_t i, const Vec3& position, const Vec3& normal, double normal_force_uN,
                    double area_mm2) const {
  if (!engaged(i) || normal_force_uN <= 0) return Vec3::Zero();
  const Vec3 offset = position - anchor_[i];
  Vec3 traction = -stiffness(area_mm2) * (offset - offset.dot(normal) * normal);
  const double limit = friction_ * normal_force_uN, size = traction.norm();
  if (size > limit) traction *= limit / size;
  return traction;
}

structure::Snapshot Tethers::save() const {
  if (friction_ <= 0) return {};
  std::vector<double> anchors;
  for (const Vec3& a : anchor_) anchors.insert(anchors.end(), {a[0], a[1], a[2]});
  return {{"engaged", engaged_}, {"anchor_mm", std::move(anchors)}};
}

void Tethers::restore(const structure::Snapshot& snapshot, const std::string& owner) {
  if (friction_ <= 0) return;
  const auto engaged = snapshot.find("engaged"), anchors = snapshot.find("anchor_mm");
  if (engaged == snapshot.end() || anchors == snapshot.end() || engaged->second.size() != engaged_.size() ||
      anchors->second.size() != 3 * anchor_.size())
    throw InputError("{}: the state holds no friction anchors for {} nodes; it was written with another case",
                     owner, anchor_.size());
  engaged_ = engaged->second;
  for (std::size_t i = 0; i < anchor_.size(); ++i)
    anchor_[i] = Vec3(anchors->second[3 * i], anchors->second[3 * i + 1], anchors->second[3 * i + 2]);
}

}  // namespace valsalva::contact
