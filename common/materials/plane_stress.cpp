#include "materials/plane_stress.hpp"

#include "materials/plane_in_space.hpp"
#include "materials/thickness_stretch.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials {

PlaneTangent ElasticLaw::plane(const Eigen::Matrix2d& c, const PlaneFibres& fibres, double factor,
                               Derivatives wanted) const {
  const ThicknessStretch c33 = thickness_stretch(c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0));
  const ElasticResponse space = respond(in_space(c, c33.value), in_space(fibres), factor, wanted);
  Eigen::Matrix2d cofactor;
  cofactor << c(1, 1), -c(0, 1), -c(1, 0), c(0, 0);
  const double s33 = space.stress(2, 2);

  PlaneTangent r;
  r.at = {space.energy, space.stress.topLeftCorner<2, 2>() + s33 * c33.first * cofactor, space.exponent,
          c33.value};
  if (wanted == Derivatives::stress) return r;

  const PlaneBlocks d = plane_blocks(space.tangent);
  const Eigen::Vector3d k = plane_voigt(cofactor), g = c33.first * k;  // dC33/dC
  r.tangent = d.plane + d.coupling * g.transpose() + g * d.coupling.transpose() +
              d.thickness * g * g.transpose() +
              2 * s33 * (c33.second * k * k.transpose() + c33.first * plane_determinant_hessian());
  return r;
}

}  // namespace valsalva::materials
