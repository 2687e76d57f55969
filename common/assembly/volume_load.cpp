#include "assembly/volume_load.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::assembly {

VolumeLoad::VolumeLoad(std::string name, std::vector<Triangle> triangles, const Vec3& apex,
                       const Points& reference, double ratio, double bulk_Pa, TimeTable factor)
    : name_(std::move(name)),
      triangles_(std::move(triangles)),
      apex_(apex),
      ratio_(ratio),
      bulk_(bulk_Pa),
      factor_(std::move(factor)) {
  for (const Triangle& t : triangles_) nodes_.insert(nodes_.end(), t.begin(), t.end());
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  for (const Triangle& t : triangles_) {
    Triangle own;
    for (int k = 0; k < 3; ++k)
      own[k] = static_cast<int>(std::lower_bound(nodes_.begin(), nodes_.end(), t[k]) - nodes_.begin());
    local_.push_back(own);
  }
  reference_volume_ = volume_mm3(reference);
  if (!(reference_volume_ > 0))
    throw InputError(
        "{}: the surface encloses {} mm3; expected a positive volume: normals outwards, point_mm inside "
        "or on the symmetry planes",
        name_, reference_volume_);
}

double VolumeLoad::volume_mm3(const Points& x) const {
  double six = 0;
  for (const Triangle& t : triangles_) six += (x[t[0]] - apex_).dot((x[t[1]] - apex_).cross(x[t[2]] - apex_));
  return six / 6;
}

double VolumeLoad::pressure_Pa(const structure::Configuration& now) const {
  const double wanted = reference_volume_ * (1 + (ratio_ - 1) * factor_(now.time_s));
  return bulk_ * (wanted - volume_mm3(now.x)) / reference_volume_;
}

Points VolumeLoad::gradient(const Points& x) const {
  Points g(nodes_.size(), Vec3::Zero());
  for (std::size_t e = 0; e < triangles_.size(); ++e)
    for (int k = 0; k < 3; ++k)
      g[local_[e][k]] +=
          (x[triangles_[e][(k + 1) % 3]] - apex_).cross(x[triangles_[e][(k + 2) % 3]] - apex_) / 6;
  return g;
}

double VolumeLoad::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  const double p = pressure_Pa(now);
  const Points g = gradient(now.x);
  for (std::size_t i = 0; i < nodes_.size(); ++i) out.force[nodes_[i]] += p * g[i];
  return 0.5 * p * p * reference_volume_ / bulk_;
}

void VolumeLoad::add_stiffness_bound(const structure::Configuration& now,
                                     structure::StiffnessBound& out) const {
  const double p = std::abs(pressure_Pa(now));
  const Points g = gradient(now.x);
  double sum = 0;
  for (const Vec3& v : g) sum += v.lpNorm<1>();
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    out.translation[nodes_[i]] += bulk_ / reference_volume_ * g[i].lpNorm<Eigen::Infinity>() * sum;
  for (const Triangle& t : triangles_)
    for (int k = 0; k < 3; ++k)
      out.translation[t[k]] +=
          p / 6 * ((now.x[t[(k + 1) % 3]] - apex_).norm() + (now.x[t[(k + 2) % 3]] - apex_).norm());
}

void VolumeLoad::add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const {
  const double p = pressure_Pa(now);
  const Points g = gradient(now.x);
  Eigen::VectorXd v(3 * nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) v.segment<3>(3 * static_cast<Eigen::Index>(i)) = g[i];
  out.add_rank_one(nodes_, v, bulk_ / reference_volume_);
  for (const Triangle& t : triangles_)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      out.add(a, b, p / 6 * structure::cross_matrix(now.x[c] - apex_));
      out.add(a, c, -p / 6 * structure::cross_matrix(now.x[b] - apex_));
    }
}

}  // namespace valsalva::assembly
