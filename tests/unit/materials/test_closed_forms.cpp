// Stress-stretch curves of incompressible sheets against formulas written from the textbook (Cauchy stress,
// third direction free), not from the code's invariants:
//   isotropic W(I1, I2), uniaxial     s = 2 (l^2 - 1/l) (W1 + W2/l)
//                        equibiaxial  s = 2 (l^2 - l^-4) (W1 + l^2 W2)
//                        simple shear s12 = 2 g (W1 + W2), s11 = 2 g^2 W1, s22 = -2 g^2 W2
//   Ogden                uniaxial     s = sum mu (l^a - l^(-a/2)), equibiaxial s = sum mu (l^a - l^(-2a)),
//                        simple shear s12 = sum mu (l^a - l^-a)/(l + 1/l), l - 1/l = g
//   fibre along the pull: + 2 W4 l^2.
// Exponents stay below 6, where the plain exponential holds.
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "materials/holzapfel.hpp"
#include "materials/lee_sacks.hpp"
#include "materials/sheet_test.hpp"
#include "samples.hpp"

using namespace valsalva;
using namespace valsalva::materials;

namespace {

const std::vector<double> stretches{0.8, 0.9, 0.98, 1.02, 1.06, 1.15, 1.4};
const std::vector<double> shears{-0.4, 0.05, 0.3, 1.0};

PlaneFibres fibres_at(std::vector<double> angles_deg) {
  MaterialSet set;
  set.fibre_angles_deg = std::move(angles_deg);
  return set.plane_fibres();
}

SheetState uniaxial(const PlaneLaw& law, double l, const PlaneFibres& f = {}) {
  return sheet_test(law, f, {l, {}, 0});
}
SheetState equibiaxial(const PlaneLaw& law, double l, const PlaneFibres& f = {}) {
  return sheet_test(law, f, {l, l, 0});
}
SheetState shear(const PlaneLaw& law, double g, const PlaneFibres& f = {}) {
  return sheet_test(law, f, {1, 1, g});
}

void expect_close(double found, double expected, double modulus, const std::string& what) {
  EXPECT_NEAR(found, expected, 1e-9 * (std::abs(expected) + modulus)) << what;
}

double square(double x) {
  return x * x;
}

// W1(I1) and a constant W2, in the three tests.
void check_isotropic(const PlaneLaw& law, const std::function<double(double)>& w1, double w2,
                     double modulus) {
  for (const double l : stretches) {
    const double i1 = l * l + 2 / l;
    expect_close(uniaxial(law, l).cauchy_Pa(0, 0), 2 * (l * l - 1 / l) * (w1(i1) + w2 / l), modulus,
                 "uniaxial");
    expect_close(uniaxial(law, l).stretch2, 1 / std::sqrt(l), 1, "lateral stretch");
    const double i1b = 2 * l * l + std::pow(l, -4);
    expect_close(equibiaxial(law, l).cauchy_Pa(1, 1), 2 * (l * l - std::pow(l, -4)) * (w1(i1b) + l * l * w2),
                 modulus, "equibiaxial");
  }
  for (const double g : shears) {
    const double w = w1(3 + g * g);
    const SheetState s = shear(law, g);
    expect_close(s.cauchy_Pa(0, 1), 2 * g * (w + w2), modulus, "shear 12");
    expect_close(s.cauchy_Pa(0, 0), 2 * g * g * w, modulus, "shear 11");
    expect_close(s.cauchy_Pa(1, 1), -2 * g * g * w2, modulus, "shear 22");
  }
}

}  // namespace

TEST(ClosedForms, NeoHookean) {
  check_isotropic(
      *make_law("neo-hookean", {{"mu_Pa", 3e4}}), [](double) { return 1.5e4; }, 0, 3e4);
}

TEST(ClosedForms, MooneyRivlin) {
  check_isotropic(
      *make_law("mooney-rivlin", {{"c1_Pa", 2e4}, {"c2_Pa", 7e3}}), [](double) { return 2e4; }, 7e3, 5e4);
}

TEST(ClosedForms, ExponentialNeoHookean) {
  check_isotropic(
      *make_law("exponential-neo-hookean", {{"c10_Pa", 1e3}, {"c01", 4}}),
      [](double i1) { return 4e3 * std::exp(4 * (i1 - 3)); }, 0, 8e3);
}

TEST(ClosedForms, LeeSacksWithoutFibres) {
  check_isotropic(
      *make_law("lee-sacks", {{"c0_Pa", 6e4}, {"c1_Pa", 1e4}, {"c2", 3}, {"w", 1}}),
      [](double i1) { return 3e4 + 1e4 * 3 * (i1 - 3) * std::exp(3 * square(i1 - 3)); }, 0, 6e4);
}

TEST(ClosedForms, LeeSacksWithoutFibresIsALawOfEvenlyDispersedFibres) {
  const LeeSacksParameters p{6e4, 1e4, 3, 1, 1};
  const LeeSacks law(p);
  const Hgo same(as_hgo(p));
  for (const double l : stretches)
    EXPECT_NEAR(uniaxial(same, l, fibres_at({20})).cauchy_Pa(0, 0), uniaxial(law, l).cauchy_Pa(0, 0),
                1e-3 * std::abs(uniaxial(law, l).cauchy_Pa(0, 0)))
        << l;
  EXPECT_NEAR(same.matrix_modulus_Pa(), 3 * p.c0_Pa, 1e-9 * p.c0_Pa);
  EXPECT_THROW(as_hgo(LeeSacksParameters{6e4, 1e4, 3, 1, 0.9}), InputError);
}

TEST(ClosedForms, HolzapfelWithEqualFamiliesIsAnHgoLaw) {
  const HolzapfelParameters p{2e4, {5e4, 5e4}, {3, 3}};
  const Holzapfel law(p);
  const Hgo same(as_hgo(p));
  for (const double l : stretches)
    EXPECT_NEAR(uniaxial(same, l, fibres_at({0, 90})).cauchy_Pa(0, 0),
                uniaxial(law, l, fibres_at({0, 90})).cauchy_Pa(0, 0),
                2e-3 * std::abs(uniaxial(law, l, fibres_at({0, 90})).cauchy_Pa(0, 0)))
        << l;
  EXPECT_THROW(as_hgo(HolzapfelParameters{2e4, {5e4, 4e4}, {3, 3}}), InputError);
}

TEST(ClosedForms, Ogden) {
  const std::vector<std::pair<double, double>> terms{{6.3e5, 1.3}, {1.2e3, 5}, {-1e4, -2}};
  const auto law = make_law("ogden", {{"mu1_Pa", 6.3e5},
                                      {"alpha1", 1.3},
                                      {"mu2_Pa", 1.2e3},
                                      {"alpha2", 5},
                                      {"mu3_Pa", -1e4},
                                      {"alpha3", -2}});
  const auto sum = [&](const std::function<double(double)>& of_alpha) {
    double s = 0;
    for (const auto& [mu, alpha] : terms) s += mu * of_alpha(alpha);
    return s;
  };
  for (const double l : stretches) {
    expect_close(uniaxial(*law, l).cauchy_Pa(0, 0),
                 sum([&](double a) { return std::pow(l, a) - std::pow(l, -a / 2); }), 6e5, "uniaxial");
    expect_close(equibiaxial(*law, l).cauchy_Pa(0, 0),
                 sum([&](double a) { return std::pow(l, a) - std::pow(l, -2 * a); }), 6e5, "equibiaxial");
  }
  for (const double g : shears) {
    const double l = 0.5 * (g + std::sqrt(g * g + 4));
    expect_close(shear(*law, g).cauchy_Pa(0, 1),
                 sum([&](double a) { return (std::pow(l, a) - std::pow(l, -a)) / (l + 1 / l); }), 6e5,
                 "shear");
  }
}

TEST(ClosedForms, OgdenOfExponentsTwoAndMinusTwoIsMooneyRivlin) {
  const auto ogden = make_law("ogden", {{"mu1_Pa", 4e4}, {"alpha1", 2}, {"mu2_Pa", -1.4e4}, {"alpha2", -2}});
  const auto mooney = make_law("mooney-rivlin", {{"c1_Pa", 2e4}, {"c2_Pa", 7e3}});
  for (const double l : stretches)
    expect_close(uniaxial(*ogden, l).cauchy_Pa(0, 0), uniaxial(*mooney, l).cauchy_Pa(0, 0), 5e4, "uniaxial");
  for (const double g : shears)
    EXPECT_LT((shear(*ogden, g).cauchy_Pa - shear(*mooney, g).cauchy_Pa).norm(), 1e-9 * 5e4) << "shear";
}

TEST(ClosedForms, HgoWithFibresAlongAndAcrossThePull) {
  const double c10 = 1e3, c01 = 4, k1 = 5e4, k2 = 6;
  const auto law = make_law("hgo", {{"c10_Pa", c10}, {"c01", c01}, {"k1_Pa", k1}, {"k2", k2}});
  const auto matrix = [&](double i1) { return 2 * c10 * c01 * std::exp(c01 * (i1 - 3)); };  // 2 W1
  const auto fibre = [&](double i4) {
    return i4 > 1 ? 2 * k1 * (i4 - 1) * std::exp(k2 * square(i4 - 1)) : 0.0;
  };
  for (const double l : stretches) {
    const double u = matrix(l * l + 2 / l) * (l * l - 1 / l);
    expect_close(uniaxial(*law, l, fibres_at({0})).cauchy_Pa(0, 0), u + l * l * fibre(l * l), 8e3, "along");
    if (l > 1) expect_close(uniaxial(*law, l, fibres_at({90})).cauchy_Pa(0, 0), u, 8e3, "across, slack");
    // Two families at +-30 degrees, equal stretches: I4 = l^2 for both.
    const double b = matrix(2 * l * l + std::pow(l, -4)) * (l * l - std::pow(l, -4));
    const SheetState s = equibiaxial(*law, l, fibres_at({30, -30}));
    expect_close(s.cauchy_Pa(0, 0), b + 2 * 0.75 * l * l * fibre(l * l), 8e3, "equibiaxial, mean direction");
    expect_close(s.cauchy_Pa(1, 1), b + 2 * 0.25 * l * l * fibre(l * l), 8e3, "equibiaxial, across");
  }
  for (const double g : shears) {  // the fibre across is drawn to sqrt(1 + g^2) and leans by g
    const SheetState s = shear(*law, g, fibres_at({90}));
    expect_close(s.cauchy_Pa(0, 1), matrix(3 + g * g) * g + g * fibre(1 + g * g), 8e3, "shear");
    expect_close(s.cauchy_Pa(1, 1), fibre(1 + g * g), 8e3, "shear, along the fibre's foot");
  }
}

TEST(ClosedForms, HgoWithDispersion) {
  const double k1 = 5e4, k2 = 6, kappa = 0.2;
  const auto law =
      make_law("hgo", {{"c10_Pa", 1e3}, {"c01", 4}, {"k1_Pa", k1}, {"k2", k2}, {"kappa", kappa}});
  const auto tension = [&](double i1, double i4) {  // dW/dE
    const double e = kappa * i1 + (1 - 3 * kappa) * std::max(i4, 1.0) - 1;
    return k1 * e * std::exp(k2 * e * e);
  };
  for (const double l : stretches) {
    const double i1 = l * l + 2 / l, t = tension(i1, l * l);
    const double isotropic = (l * l - 1 / l) * (2 * 4e3 * std::exp(4 * (i1 - 3)) + 2 * kappa * t);
    const double aligned = l > 1 ? 2 * (1 - 3 * kappa) * t * l * l : 0;
    expect_close(uniaxial(*law, l, fibres_at({0})).cauchy_Pa(0, 0), isotropic + aligned, 8e3, "uniaxial");
  }
}

TEST(ClosedForms, HolzapfelWithTwoDirections) {
  const auto law =
      make_law("holzapfel", {{"mu_Pa", 2e4}, {"a1_Pa", 5e4}, {"b1", 3}, {"a2_Pa", 1e4}, {"b2", 5}});
  const auto fibre = [](double a, double b, double i4) {
    return i4 > 1 ? 2 * a * (i4 - 1) * std::exp(b * square(i4 - 1)) : 0.0;
  };
  const PlaneFibres f = fibres_at({0, 90});
  for (const double l : stretches) {
    if (l > 1)
      expect_close(uniaxial(*law, l, f).cauchy_Pa(0, 0), 2e4 * (l * l - 1 / l) + l * l * fibre(5e4, 3, l * l),
                   2e4, "uniaxial");
    const double matrix = 2e4 * (l * l - std::pow(l, -4));
    const SheetState s = equibiaxial(*law, l, f);
    expect_close(s.cauchy_Pa(0, 0), matrix + l * l * fibre(5e4, 3, l * l), 2e4, "first family");
    expect_close(s.cauchy_Pa(1, 1), matrix + l * l * fibre(1e4, 5, l * l), 2e4, "second family");
  }
  for (const double g : shears)
    expect_close(shear(*law, g, f).cauchy_Pa(0, 1), 2e4 * g + g * fibre(1e4, 5, 1 + g * g), 2e4, "shear");
}

TEST(ClosedForms, LeeSacksWithFibre) {
  const double w = 0.4;
  const auto law = make_law("lee-sacks", {{"c0_Pa", 6e4}, {"c1_Pa", 1e4}, {"c2", 3}, {"c3", 5}, {"w", w}});
  for (const double l : stretches) {
    const double x = l * l + 2 / l - 3, y = l > 1 ? l * l - 1 : 0;
    const double isotropic = (l * l - 1 / l) * (6e4 + w * 1e4 * 2 * 3 * x * std::exp(3 * x * x));
    const double aligned = 2 * l * l * (1 - w) * 1e4 * 5 * y * std::exp(5 * y * y);
    expect_close(uniaxial(*law, l, fibres_at({0})).cauchy_Pa(0, 0), isotropic + aligned, 6e4, "uniaxial");
  }
}

TEST(ClosedForms, LeeSacksSharesItsFibreTermBetweenTwoFamilies) {
  const auto law = make_law("lee-sacks", {{"c0_Pa", 6e4}, {"c1_Pa", 1e4}, {"c2", 3}, {"c3", 5}, {"w", 0.4}});
  expect_close(equibiaxial(*law, 1.2, fibres_at({0, 0})).cauchy_Pa(0, 0),
               equibiaxial(*law, 1.2, fibres_at({0})).cauchy_Pa(0, 0), 6e4, "two families along one line");
}

TEST(ClosedForms, StraightenedFibre) {
  const double c3 = 1e5, c4 = 20, straight = 1.1;
  const double c5 = c3 * c4 * std::exp(c4 * 0.1), c6 = c3 * (std::exp(c4 * 0.1) - 1) - c5 * straight;
  const auto law = make_law(
      "straightened-fibre",
      {{"c1_Pa", 6e4}, {"c2_Pa", 1e4}, {"c3_Pa", c3}, {"c4", c4}, {"straightening_stretch", straight}});
  for (const double l : stretches) {
    const double matrix = 2 * (l * l - 1 / l) * (6e4 + 1e4 / l);
    const double fibre = l < 1          ? 0
                         : l < straight ? c3 * (std::exp(c4 * (l - 1)) - 1)
                                        : c5 * l + c6;  // l dF/dl
    expect_close(uniaxial(*law, l, fibres_at({0})).cauchy_Pa(0, 0), matrix + fibre, 1e5, "uniaxial");
  }
}

TEST(ClosedForms, StraightenedFibreStoresTheWorkDoneOnIt) {
  // The energy has a closed form of its own (exponential integral): against Simpson's rule of the published
  // dF/dl, through the crimped range, the continued exponential (beyond 1 + 6/C4) and the straight one.
  const double c3 = 1e5, c4 = 30, straight = 1.35, cap = 1 + 6 / c4;
  const auto law = make_law("straightened-fibre",
                            {{"c1_Pa", 6e4}, {"c3_Pa", c3}, {"c4", c4}, {"straightening_stretch", straight}});
  const double top = std::exp(6.0), d = c4 * (straight - cap);
  const double at_straight = c3 * (top * (1 + d + d * d / 2) - 1), c5 = c3 * c4 * top * (1 + d);
  const auto slope = [&](double l) {
    const double q = c4 * (l - 1);
    if (l < cap) return c3 / l * (std::exp(q) - 1);
    if (l < straight) return c3 / l * (top * (1 + (q - 6) + square(q - 6) / 2) - 1);
    return (at_straight + c5 * (l - straight)) / l;
  };
  const auto simpson = [&](double from, double to) {
    const int n = 2000;
    const double h = (to - from) / n;
    double s = slope(from) + slope(std::nextafter(to, from));
    for (int i = 1; i < n; ++i) s += (i % 2 ? 4 : 2) * slope(from + i * h);
    return s * h / 3;
  };
  const auto stored = [&](double l) {
    const Mat3 c = Vec3(l * l, 1, 1).asDiagonal();
    return law->respond(c, {1}, 1, Derivatives::stress).energy -
           law->respond(c, {0}, 1, Derivatives::stress).energy;
  };
  const double crimped = simpson(1, 1.15), to_cap = simpson(1, cap),
               to_straight = to_cap + simpson(cap, straight);
  EXPECT_NEAR(stored(1.15), crimped, 1e-9 * crimped);
  EXPECT_NEAR(stored(straight), to_straight, 1e-9 * to_straight);
  EXPECT_NEAR(stored(1.6), to_straight + simpson(straight, 1.6), 1e-9 * to_straight);
}

TEST(ClosedForms, Fung) {
  const double ch = 5e5, b1 = 4, b2 = 0.5, b3 = 0.8;
  const auto law = make_law("fung", {{"ch_Pa", ch}, {"b1", b1}, {"b2", b2}, {"b3", b3}});
  for (const double l : stretches) {
    const double e = 0.5 * (l * l - 1), t = 0.5 * (std::pow(l, -4) - 1);
    const double q = b1 * e * e + b2 * (e * e + t * t);
    if (q > 5) continue;
    const double c = ch * std::exp(q);
    const SheetState s = equibiaxial(*law, l, fibres_at({0}));
    expect_close(s.cauchy_Pa(0, 0), c * (l * l * b1 * e - std::pow(l, -4) * b2 * t), ch, "along");
    expect_close(s.cauchy_Pa(1, 1), c * (l * l * b2 * e - std::pow(l, -4) * b2 * t), ch, "across");
  }
  for (const double g : shears) {
    const double e12 = g / 2, e22 = g * g / 2;
    const double c = ch * std::exp(b2 * e22 * e22 + 2 * b3 * e12 * e12);
    const SheetState s = shear(*law, g, fibres_at({0}));
    expect_close(s.cauchy_Pa(0, 1), c * (b3 * e12 + g * b2 * e22), ch, "shear");
    expect_close(s.cauchy_Pa(1, 1), c * b2 * e22, ch, "shear, across");
  }
  // Uniaxial: the free direction bears no load, and along the fibre the stress is that of the two strains
  // left.
  for (const double l : {1.02, 1.1, 1.2}) {
    const SheetState s = uniaxial(*law, l, fibres_at({0}));
    const double e1 = 0.5 * (l * l - 1), e2 = 0.5 * (square(s.stretch2) - 1),
                 e3 = 0.5 * (square(s.stretch3) - 1);
    expect_close(s.stretch1 * s.stretch2 * s.stretch3, 1, 1, "volume");
    const double c = ch * std::exp(b1 * e1 * e1 + b2 * (e2 * e2 + e3 * e3));
    const double pressure = square(s.stretch3) * b2 * e3;
    expect_close(square(s.stretch2) * b2 * e2, pressure, 1, "free directions bear the same");
    expect_close(s.cauchy_Pa(0, 0), c * (l * l * b1 * e1 - pressure), ch, "uniaxial");
  }
}

TEST(ClosedForms, StVenantKirchhoff) {
  const double lambda = 9.3e6, mu = 4e6, nu = lambda / (2 * (lambda + mu)), young = 2 * mu * (1 + nu);
  const SolidLaw law(make_law("st-venant-kirchhoff", {{"lambda_Pa", lambda}, {"mu_Pa", mu}}), {},
                     Split::full);
  for (const double l : {0.8, 0.95, 1.05, 1.2}) {
    const double e = 0.5 * (l * l - 1);
    const SheetState u = uniaxial(law, l);
    expect_close(u.nominal1_Pa, l * young * e, young, "uniaxial");
    expect_close(u.stretch2, std::sqrt(1 - 2 * nu * e), 1, "lateral stretch");
    const SheetState b = equibiaxial(law, l);
    expect_close(b.nominal2_Pa, l * young / (1 - nu) * e, young, "equibiaxial");
    expect_close(b.stretch3, std::sqrt(1 - 2 * nu / (1 - nu) * 2 * e), 1, "thickness");
  }
  for (const double g : {0.05, 0.3}) {
    // E11 = 0, E22 = g^2/2, E12 = g/2: plane stress S = Y/(1 - nu^2) (E + nu cof E).
    const double s22 = young / (1 - nu * nu) * g * g / 2, s11 = nu * s22, s12 = mu * g;
    const SheetState s = shear(law, g);
    expect_close(s.nominal1_Pa, s11 + g * s12, young, "shear 11");
    expect_close(s.nominal2_Pa, s22, young, "shear 22");
    expect_close(s.cauchy_Pa(0, 1) * s.stretch3, s12 + g * s22, young, "shear 12");
  }
}

TEST(ClosedForms, CompressibleNeoHookeanWithLogarithmicTerm) {
  // Simo and Pister: sigma = mu/J (B - 1) + lambda ln J / J. Uniaxial: the lateral stretch r with
  // mu (r^2 - 1) + lambda ln(l r^2) = 0.
  const double mu = 3e4, lambda = 8e4;
  const SolidLaw law(make_law("neo-hookean", {{"mu_Pa", mu}}), {Volumetric::Form::logarithmic, lambda},
                     Split::full);
  for (const double l : {0.7, 0.95, 1.1, 1.5}) {
    const SheetState s = uniaxial(law, l);
    const double r2 = square(s.stretch2), j = l * r2;
    EXPECT_NEAR(s.stretch2, s.stretch3, 1e-9) << l;
    expect_close(mu * (r2 - 1) + lambda * std::log(j), 0, mu, "no lateral load");
    expect_close(s.cauchy_Pa(0, 0), mu / j * (l * l - 1) + lambda * std::log(j) / j, mu, "uniaxial");
  }
}

TEST(ClosedForms, NearlyIncompressibleTendsToIncompressibleWithTheBulkModulus) {
  // The difference must fall as 1/K.
  for (const samples::Sample& s : samples::all()) {
    const PlaneFibres f = samples::two_plane_fibres();
    const SheetLoad load{1.07, 1.02, 0.05};
    const double exact = sheet_test(*s.law, f, load).cauchy_Pa(0, 0);
    const auto error = [&](double k) {
      return std::abs(sheet_test(SolidLaw(s.law, {Volumetric::Form::j_ln_j, k}), f, load).cauchy_Pa(0, 0) -
                      exact);
    };
    const double coarse = error(1e8), fine = error(2e8);
    EXPECT_LT(fine, 0.05 * std::abs(exact)) << s.name;
    EXPECT_NEAR(std::log2(coarse / fine), 1, 0.05) << s.name << ": " << coarse << " " << fine;
  }
}
