#include "structure/beam_fibres.hpp"

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {

FibreSection::FibreSection(const materials::Superelastic& law, const FibreGrid& grid)
    : law_(law), grid_(grid) {
  for (int count : {grid.width, grid.depth, grid.stations})
    if (count < 1 || count > 20)
      throw InputError("beams: {} x {} fibres at {} stations; expected 1 to 20 each", grid.width, grid.depth,
                       grid.stations);
  width_ = gauss(grid.width);
  depth_ = gauss(grid.depth);
  along_ = gauss(grid.stations);
}

// Roots of Legendre's polynomial by Newton's method (Press et al. 2007, Numerical Recipes, section 4.6.1).
FibreSection::Points FibreSection::gauss(int count) {
  Points points;
  for (int i = 0; i < count; ++i) {
    double x = -std::cos(M_PI * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p = 1, before = 0;
      for (int k = 1; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      const double change = p / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    points.at.push_back(2 * i + 1 == count ? 0 : x);
    points.weight.push_back(2 / ((1 - x * x) * slope * slope));
  }
  return points;
}

FibreSection::Response FibreSection::respond(const Shape& shape, const BeamMeasures& q,
                                             const materials::SuperelasticState* from,
                                             materials::SuperelasticState* to, bool with_stiffness) const {
  const double length = shape.length_mm;
  Response out;
  int fibre = 0;
  for (int g = 0; g < grid_.stations; ++g) {
    const double s = 0.5 * (1 + along_.at[g]), near = (6 * s - 4) / length, far = (6 * s - 2) / length;
    const double axial = q[0] / length, kz = near * q[1] + far * q[2], ky = near * q[3] + far * q[4];
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, M_z, M_y of the station
    Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
    double stored = 0, dissipated = 0;
    for (int i = 0; i < grid_.width; ++i)
      for (int j = 0; j < grid_.depth; ++j, ++fibre) {
        const double y = 0.5 * shape.width_mm * width_.at[i], z = 0.5 * shape.depth_mm * depth_.at[j];
        const double area = 0.25 * shape.width_mm * shape.depth_mm * width_.weight[i] * depth_.weight[j];
        const materials::SuperelasticResponse r = law_.respond(from[fibre], axial - y * kz + z * ky);
        const Eigen::Vector3d arm(1, -y, z);
        force += area * r.state.stress_Pa * arm;
        if (with_stiffness) stiffness += area * r.tangent_Pa * arm * arm.transpose();
        stored += area * r.stored_Pa;
        dissipated += area * r.dissipated_Pa;
        if (to) to[fibre] = r.state;
      }
    const double part = 0.5 * along_.weight[g] * length;
    Eigen::Matrix<double, 3, 6> b = Eigen::Matrix<double, 3, 6>::Zero();
    b(0, 0) = 1 / length;
    b(1, 1) = b(2, 3) = near;
    b(1, 2) = b(2, 4) = far;
    out.force += part * b.transpose() * force;
    if (with_stiffness) out.stiffness += part * b.transpose() * stiffness * b;
    out.stored_nJ += part * stored;
    out.dissipated_nJ += part * dissipated;
  }
  return out;
}

}  // namespace valsalva::structure
