#include "structure/kirchhoff_section.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;

struct GaussPoint {
  double at, weight;  // on [-1/2, 1/2]
};

std::vector<GaussPoint> gauss(int points) {
  switch (points) {
    case 1:
      return {{0, 1}};
    case 2: {
      const double a = 0.5 / std::sqrt(3.0);
      return {{-a, 0.5}, {a, 0.5}};
    }
    case 3: {
      const double a = 0.5 * std::sqrt(0.6);
      return {{-a, 5. / 18}, {0, 8. / 18}, {a, 5. / 18}};
    }
    case 4: {
      const double r = std::sqrt(1.2), s = std::sqrt(30.0);
      const double a = 0.5 * std::sqrt((3 - 2 * r) / 7), b = 0.5 * std::sqrt((3 + 2 * r) / 7);
      const double wa = (18 + s) / 72, wb = (18 - s) / 72;
      return {{-b, wb}, {-a, wa}, {a, wa}, {b, wb}};
    }
    case 5: {
      const double r = 2 * std::sqrt(10.0 / 7), s = 13 * std::sqrt(70.0);
      const double a = std::sqrt(5 - r) / 6, b = std::sqrt(5 + r) / 6;
      const double wa = (322 + s) / 1800, wb = (322 - s) / 1800;
      return {{-b, wb}, {-a, wa}, {0, 64. / 225}, {a, wa}, {b, wb}};
    }
    default:
      throw InputError("shell: {} quadrature points through the thickness; expected 1 to 5", points);
  }
}

// x -> a x a for symmetric a and x, as it acts on engineering strains (11, 22, 2 12).
Matrix3d congruence(const Matrix2d& a) {
  const double p = a(0, 0), q = a(1, 1), r = a(0, 1);
  Matrix3d m;
  m << p * p, r * r, p * r, r * r, q * q, q * r, 2 * p * r, 2 * q * r, p * q + r * r;
  return m;
}

class LawSection : public SectionModel {
 public:
  LawSection(std::shared_ptr<const materials::PlaneLaw> law, int points, const SectionScales& scales)
      : law_(std::move(law)) {
    VALSALVA_ASSERT(law_);
    for (const GaussPoint& g : gauss(points))
      layers_.push_back({g.at * scales.flexural_thickness, g.weight * scales.flexural_thickness});
    const double membrane = scales.membrane_thickness - scales.flexural_thickness;
    if (membrane == 0) return;
    for (GaussPoint& layer : layers_)
      if (layer.at == 0) {
        layer.weight += membrane;
        return;
      }
    layers_.push_back({0, membrane});
  }

  void check(const SectionPoint& p) const override {
    const double bend = largest_curvature(p.curvature) * p.thickness;
    for (const GaussPoint& layer : layers_)
      if (2 * std::abs(layer.at) * bend > 0.8)
        throw InputError(
            "thickness {:.3g} mm, but the stress-free shape has a radius of curvature of {:.3g} mm; expected "
            "less than the radius: smooth the shape, or use solids",
            p.thickness, p.thickness / bend);
  }

  SectionResponse respond(const SectionPoint& p, const Matrix2d& c, const Matrix2d& k,
                          bool tangent) const override {
    SectionResponse r;
    for (const GaussPoint& layer : layers_) {
      const double zeta = layer.at * p.thickness;
      const Pull pull = pull_back(p, zeta);
      const Matrix2d cz = pull.inverse * (c - 2 * zeta * k) * pull.inverse;
      const double w = layer.weight * p.thickness * pull.volume;
      materials::PlaneTangent now;
      if (tangent)
        now = law_->plane_tangent(cz, p.fibres, p.factor);
      else
        now.at = law_->plane_stress(cz, p.fibres, p.factor);
      const Matrix2d s = w * pull.inverse * now.at.stress * pull.inverse;
      r.energy += w * now.at.energy;
      r.exponent = std::max(r.exponent, now.at.exponent);
      r.force += s;
      r.moment -= zeta * s;
      if (!tangent) continue;
      const Matrix3d t = congruence(pull.inverse);
      const Matrix3d d = w * t.transpose() * now.tangent * t;
      r.tangent.topLeftCorner<3, 3>() += d;
      r.tangent.topRightCorner<3, 3>() -= zeta * d;
      r.tangent.bottomLeftCorner<3, 3>() -= zeta * d;
      r.tangent.bottomRightCorner<3, 3>() += zeta * zeta * d;
    }
    return r;
  }

  SectionStress stress(const SectionPoint& p, const Matrix2d& c, const Matrix2d& k,
                       double height) const override {
    const double zeta = height * p.thickness;
    const Pull pull = pull_back(p, zeta);
    const Matrix2d cz = pull.inverse * (c - 2 * zeta * k) * pull.inverse;
    const materials::PlaneStress s = law_->plane_stress(cz, p.fibres, p.factor);
    return {cz, s.stress, s.exponent};
  }

 private:
  struct Pull {
    Matrix2d inverse;  // S^-1
    double volume;     // det S
  };

  static double largest_curvature(const Matrix2d& k) {
    const double mean = 0.5 * k.trace(), half = 0.5 * (k(0, 0) - k(1, 1));
    return std::abs(mean) + std::sqrt(half * half + k(0, 1) * k(0, 1));
  }

  // Square root of a symmetric 2x2 matrix m: (m + sqrt(det m)) / sqrt(tr m + 2 sqrt(det m)).
  static Pull pull_back(const SectionPoint& p, double zeta) {
    const Matrix2d m = Matrix2d::Identity() - 2 * zeta * p.curvature;
    const double root = std::sqrt(m.determinant());
    const Matrix2d s = (m + root * Matrix2d::Identity()) / std::sqrt(m.trace() + 2 * root);
    return {s.inverse(), root};
  }

  std::shared_ptr<const materials::PlaneLaw> law_;
  std::vector<GaussPoint> layers_;
};

class KoiterSection : public SectionModel {
 public:
  KoiterSection(double modulus, double poisson, const SectionScales& scales) : scales_(scales) {
    if (!(modulus > 0) || !(poisson > -1 && poisson <= 0.5))
      throw InputError("shell: modulus {} Pa, Poisson's ratio {}; expected a positive one, and -1 to 0.5",
                       modulus, poisson);
    const double e = modulus / (1 - poisson * poisson);
    h_ << e, poisson * e, 0, poisson * e, e, 0, 0, 0, 0.5 * (1 - poisson) * e;
  }

  SectionResponse respond(const SectionPoint& p, const Matrix2d& c, const Matrix2d& k,
                          bool tangent) const override {
    const double t = p.thickness * scales_.membrane_thickness * p.factor;
    const double f = p.thickness * scales_.flexural_thickness;
    const double bend = p.factor * f * f * f / 12;
    const Matrix2d eps = 0.5 * (c - Matrix2d::Identity()), kappa = k - p.curvature;
    SectionResponse r;
    r.force = t * stress_of(eps);
    r.moment = bend * stress_of(kappa);
    r.energy = 0.5 * (r.force.cwiseProduct(eps).sum() + r.moment.cwiseProduct(kappa).sum());
    if (tangent) {
      r.tangent.topLeftCorner<3, 3>() = t * h_;
      r.tangent.bottomRightCorner<3, 3>() = bend * h_;
    }
    return r;
  }

  SectionStress stress(const SectionPoint& p, const Matrix2d& c, const Matrix2d& k,
                       double height) const override {
    const Matrix2d eps = 0.5 * (c - Matrix2d::Identity()) -
                         height * p.thickness * scales_.flexural_thickness * (k - p.curvature);
    return {Matrix2d::Identity() + 2 * eps, p.factor * stress_of(eps), 0};
  }

 private:
  Matrix2d stress_of(const Matrix2d& eps) const {
    Matrix2d s;
    s(0, 0) = h_(0, 0) * eps(0, 0) + h_(0, 1) * eps(1, 1);
    s(1, 1) = h_(0, 1) * eps(0, 0) + h_(1, 1) * eps(1, 1);
    s(0, 1) = s(1, 0) = 2 * h_(2, 2) * eps(0, 1);
    return s;
  }

  SectionScales scales_;
  Matrix3d h_;
};

void check(const SectionScales& s) {
  if (!(s.membrane_thickness > 0) || !(s.flexural_thickness >= 0))
    throw InputError(
        "shell: thickness factors {} (membrane), {} (flexure); expected positive, and not negative",
        s.membrane_thickness, s.flexural_thickness);
}

}  // namespace

std::shared_ptr<const SectionModel> law_section(std::shared_ptr<const materials::PlaneLaw> law, int points,
                                                const SectionScales& scales) {
  check(scales);
  return std::make_shared<LawSection>(std::move(law), points, scales);
}

std::shared_ptr<const SectionModel> koiter_section(double modulus_Pa, double poisson,
                                                   const SectionScales& scales) {
  check(scales);
  return std::make_shared<KoiterSection>(modulus_Pa, poisson, scales);
}

}  // namespace valsalva::structure
