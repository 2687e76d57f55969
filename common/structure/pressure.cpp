#include "structure/pressure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace valsalva::structure {

PressureTerm::PressureTerm(std::string name, std::vector<Triangle> triangles, const Body& body,
                           std::function<double(double)> pressure_Pa)
    : name_(std::move(name)),
      triangles_(std::move(triangles)),
      body_(body),
      pressure_(std::move(pressure_Pa)) {}

double PressureTerm::add_forces(const Configuration& now, Forces& out) const {
  const double p = pressure_(now.time_s);
  if (p == 0) return 0;
  for (const Triangle& t : triangles_) {
    const int a = body_.offset + t[0], b = body_.offset + t[1], c = body_.offset + t[2];
    const Vec3 third = p / 6 * (now.x[b] - now.x[a]).cross(now.x[c] - now.x[a]);
    out.force[a] += third;
    out.force[b] += third;
    out.force[c] += third;
  }
  return 0;
}

void PressureTerm::add_stiffness_bound(const Configuration& now, StiffnessBound& out) const {
  // The force changes by p/6 |edge| for a displacement of one node across an edge.
  const double p = std::abs(pressure_(now.time_s));
  for (const Triangle& t : triangles_) {
    double around = 0;
    for (int k = 0; k < 3; ++k)
      around += (now.x[body_.offset + t[k]] - now.x[body_.offset + t[(k + 1) % 3]]).norm();
    for (int a : t) out.translation[body_.offset + a] += p / 6 * around;
  }
}

void PressureTerm::add_tangent(const Configuration& now, BlockMatrix& out) const {
  const double p = pressure_(now.time_s);
  if (p == 0) return;
  for (const Triangle& t : triangles_)
    for (int k = 0; k < 3; ++k) {
      // Moving node k changes the area vector by half its displacement x the opposite edge.
      const Vec3 opposite = now.x[body_.offset + t[(k + 2) % 3]] - now.x[body_.offset + t[(k + 1) % 3]];
      const Mat3 change = -p / 6 * cross_matrix(opposite);
      for (int a : t) out.add(body_.offset + a, body_.offset + t[k], change);
    }
}

}  // namespace valsalva::structure
