// Superelastic shape-memory alloy in one dimension: stress over strain with the loops of loading and
// unloading.
//
// The fraction xi of martensite adds transformation strain, the phases share the stress (Reuss):
//   eps = sigma/E(xi) + eps_L xi sign(sigma),   1/E(xi) = (1 - xi)/E_A + xi/E_M.
// With F = |sigma| in tension and |sigma| / c in compression, c = (compressive over tensile start of
// loading),
//   loading,   s_s < F < s_f, dF > 0:   d xi = (1 - xi) dF/(s_f - F),
//   unloading, u_f < F < u_s, dF < 0:   d xi = xi dF/(F - u_f),
// elastic otherwise. Each rate equation is integrated exactly over a step in which F is monotonic,
//   1 - xi = (1 - xi_n)(s_f - F)/(s_f - max(F_n, s_s)),   xi = xi_n (F - u_f)/(min(F_n, u_s) - u_f),
// so that the stress of a monotonic strain path does not depend on the steps; with these xi is linear in F
// and the stress solves a quadratic equation. u_f > 0: there is no martensite at zero stress, and tension and
// compression never mix.
//
// Sources: Auricchio and Taylor 1997 (Comput. Methods Appl. Mech. Eng. 143:175-194): loading function of
// Drucker-Prager type, which in one dimension gives the ratio c, and the linear kinetic rules above;
// Auricchio and Sacco 1997 (Int. J. Non-Linear Mech. 32:1101-1114): the moduli of the two phases and their
// Reuss average. The temperature is constant.
//
// Energy per volume: psi = sigma^2/(2 E(xi)) + xi g, g the work of transformation at the mean m of s_s and
// u_s, g = m^2 (1/E_M - 1/E_A)/2 + eps_L m; the rest of the work is dissipated, never negative:
//   d D = [sigma^2 (1/E_M - 1/E_A)/2 + eps_L |sigma| - g] d xi.
// psi splits work into stored and lost within a loop; over a closed loop only D remains, whatever g.
// Moduli and stresses Pa; energies per volume Pa = nJ/mm3.
#pragma once

#include <string>
#include <vector>

namespace valsalva::materials {

struct SuperelasticParameters {
  double austenite_Pa = 0;           ///< E_A
  double martensite_Pa = 0;          ///< E_M
  double poisson = 0.33;             ///< for shear
  double transformation_strain = 0;  ///< eps_L
  double loading_start_Pa = 0;       ///< s_s, in tension
  double loading_finish_Pa = 0;      ///< s_f > s_s
  double unloading_start_Pa = 0;     ///< u_s <= s_s
  double unloading_finish_Pa = 0;    ///< 0 < u_f < u_s
  double compression_start_Pa = 0;   ///< c s_s
};

/// A published set and where it comes from.
struct SuperelasticSet {
  std::string name, source;
  SuperelasticParameters parameters;
};
const std::vector<SuperelasticSet>& superelastic_sets();
/// InputError lists the names that there are.
const SuperelasticParameters& superelastic_set(const std::string& name);

/// What a point remembers.
struct SuperelasticState {
  double martensite = 0;  ///< xi, negative when it came by compression
  double stress_Pa = 0;
};

struct SuperelasticResponse {
  SuperelasticState state;   ///< after the step
  double tangent_Pa = 0;     ///< d sigma/d eps, on the branch of the step
  double stored_Pa = 0;      ///< psi
  double dissipated_Pa = 0;  ///< in this step
};

class Superelastic {
 public:
  /// InputError names the parameter that does not fit.
  explicit Superelastic(const SuperelasticParameters& parameters);
  const SuperelasticParameters& parameters() const { return p_; }
  /// From a state to a strain.
  SuperelasticResponse respond(const SuperelasticState& from, double strain) const;
  /// The largest tangent modulus.
  double stiffest_Pa() const;

 private:
  struct Branch {  // one sign: stresses positive, thresholds scaled
    double load_start, load_finish, unload_start, unload_finish, work;
  };
  struct Step {
    double stress, fraction, tangent, dissipated;
  };
  Step follow(const Branch& b, double fraction, double stress, double strain) const;
  Step transform(const Branch& b, double fraction, double from, double slope, double strain) const;
  double compliance(double fraction) const { return 1 / p_.austenite_Pa + softening_ * fraction; }

  SuperelasticParameters p_;
  double softening_;  // 1/E_M - 1/E_A
  Branch tension_, compression_;
};

}  // namespace valsalva::materials
