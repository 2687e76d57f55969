// What a shell or solid asks of an incompressible law with up to two fibre families: the strain energy per
// reference volume W(I1, I4_1, I4_2) and its derivatives. A new law is a new file pair; no body changes for
// it.
//
// I1 = tr C (three-dimensional), I4_i = a_i . C a_i. `factor` multiplies the isotropic matrix part only (a
// stenotic leaflet has C10 x 1000). Pa.
#pragma once

#include <array>
#include <string>

namespace valsalva::materials {

struct InvariantResponse {
  double energy = 0;            ///< W, Pa
  double d1 = 0;                ///< dW/dI1
  double d11 = 0;               ///< d2W/dI1^2
  std::array<double, 2> d4{};   ///< dW/dI4_i
  std::array<double, 2> d44{};  ///< d2W/dI4_i^2
  std::array<double, 2> d14{};  ///< d2W/(dI1 dI4_i), for laws with dispersion
  double exponent = 0;          ///< the largest argument of an exponential, 0 for laws without one
};

class InvariantLaw {
 public:
  virtual ~InvariantLaw() = default;
  virtual std::string name() const = 0;
  virtual InvariantResponse respond(double i1, const std::array<double, 2>& i4, double factor) const = 0;
};

}  // namespace valsalva::materials
