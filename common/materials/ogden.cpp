#include "materials/ogden.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "materials/checks.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials {
namespace {

// (a^m - b^m)/(a - b), exact in the limit a -> b.
double divided_difference(double a, double b, double m) {
  const double x = (a - b) / b;
  const double slope = x == 0 ? m : std::expm1(m * std::log1p(x)) / x;
  return std::pow(b, m - 1) * slope;
}

}  // namespace

Ogden::Ogden(std::vector<OgdenTerm> terms) : terms_(std::move(terms)) {
  if (terms_.empty()) throw InputError("material ogden: no term; expected mu1_Pa and alpha1 at least");
  double modulus = 0;
  for (const OgdenTerm& t : terms_) {
    require(true, "ogden", "mu (Pa)", t.mu_Pa, "a number");
    require(t.alpha != 0, "ogden", "alpha", t.alpha, "a number other than 0");
    modulus += 0.5 * t.mu_Pa * t.alpha;
  }
  require_positive("ogden", "the shear modulus sum mu alpha/2 (Pa)", modulus);
}

ElasticResponse Ogden::respond(const Mat3& c, const Fibres&, double factor, Derivatives wanted) const {
  const Eigen::SelfAdjointEigenSolver<Mat3> spectrum(c);
  const Vec3 values = spectrum.eigenvalues();
  const Mat3& n = spectrum.eigenvectors();
  ElasticResponse r;
  Vec3 g = Vec3::Zero();
  Mat3 slope = Mat3::Zero();  // divided differences of g, g' on the diagonal
  for (const OgdenTerm& t : terms_) {
    const double mu = factor * t.mu_Pa, m = 0.5 * t.alpha - 1;
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double power = std::pow(values[i], m);
      g[i] += mu * power;
      sum += power * values[i] - 1;
      if (wanted == Derivatives::tangent)
        for (int j = 0; j <= i; ++j) slope(i, j) += mu * divided_difference(values[i], values[j], m);
    }
    r.energy += mu / t.alpha * sum;
  }
  r.stress = n * g.asDiagonal() * n.transpose();
  if (wanted == Derivatives::stress) return r;

  // D = 2 dS/dC = 2 sum_ij slope_ij M_ij M_ij with M_ij = sym(N_i N_j).
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      const Mat3 m = n.col(i) * n.col(j).transpose();
      const Voigt6 v = voigt(Mat3(0.5 * (m + m.transpose())));
      r.tangent += (i == j ? 2 : 4) * slope(i, j) * v * v.transpose();
    }
  return r;
}

}  // namespace valsalva::materials
