#include "materials/plane_stress.hpp"

#include "materials/plane_in_space.hpp"
#include "materials/thickness_stretch.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials {
namespace {

struct Sheet {
  ThicknessStretch c33;
  Eigen::Matrix2d cofactor;  // of C: d(det C)/dC
  ElasticResponse space;
};

Sheet sheet_of(const ElasticLaw& law, const Eigen::Matrix2d& c, const PlaneFibres& fibres, double factor,
               Derivatives wanted) {
  Sheet s;
  s.c33 = thickness_stretch(c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0));
  s.cofactor << c(1, 1), -c(0, 1), -c(1, 0), c(0, 0);
  s.space = law.respond(in_space(c, s.c33.value), in_space(fibres), factor, wanted);
  return s;
}

PlaneStress stress_of(const Sheet& s) {
  return {s.space.energy, s.space.exponent, s.c33.value,
          s.space.stress.topLeftCorner<2, 2>() + s.space.stress(2, 2) * s.c33.first * s.cofactor};
}

}  // namespace

PlaneStressLanes PlaneLaw::plane_stress_lanes(const PlaneLanes& at) const {
  PlaneStressLanes all;
  PlaneFibres fibres{.count = at.families};
  for (int l = 0; l < lane_count; ++l) {
    Eigen::Matrix2d c;
    c << at.c11[l], at.c12[l], at.c12[l], at.c22[l];
    for (int i = 0; i < at.families; ++i) fibres.direction[i] << at.fibre[i][0][l], at.fibre[i][1][l];
    const PlaneStress one = plane_stress(c, fibres, at.factor[l]);
    all.energy[l] = one.energy;
    all.exponent[l] = one.exponent;
    all.s11[l] = one.stress(0, 0);
    all.s22[l] = one.stress(1, 1);
    all.s12[l] = one.stress(0, 1);
  }
  return all;
}

PlaneStress ElasticLaw::plane_stress(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                     double factor) const {
  return stress_of(sheet_of(*this, c, fibres, factor, Derivatives::stress));
}

PlaneTangent ElasticLaw::plane_tangent(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                       double factor) const {
  const Sheet s = sheet_of(*this, c, fibres, factor, Derivatives::tangent);
  const PlaneBlocks d = plane_blocks(s.space.tangent);
  const Eigen::Vector3d k = plane_voigt(s.cofactor), g = s.c33.first * k;  // dC33/dC
  const Eigen::Matrix3d thickness_hessian =
      s.c33.second * k * k.transpose() + s.c33.first * plane_determinant_hessian();
  return {stress_of(s), d.plane + d.coupling * g.transpose() + g * d.coupling.transpose() +
                            d.thickness * g * g.transpose() + 2 * s.space.stress(2, 2) * thickness_hessian};
}

}  // namespace valsalva::materials
