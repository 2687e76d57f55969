// A superelastic bar under cycles of prescribed elongation against the closed form of the loop.
#include <gtest/gtest.h>

#include "scenes.hpp"

namespace valsalva {
namespace {

/// Strain of a point of the major loop at stress sigma (magnitudes; thresholds scaled by c).
struct Loop {
  SuperelasticParameters p;
  double c;

  double fraction(double sigma, bool loading) const {
    const double from = c * (loading ? p.loading_start_Pa : p.unloading_finish_Pa),
                 to = c * (loading ? p.loading_finish_Pa : p.unloading_start_Pa);
    return std::clamp((sigma - from) / (to - from), 0.0, 1.0);
  }
  double strain(double sigma, bool loading) const {
    const double xi = fraction(sigma, loading);
    return sigma * ((1 - xi) / p.austenite_Pa + xi / p.martensite_Pa) + p.transformation_strain * xi;
  }
  /// Stress by bisection of the strain, which rises with it.
  double stress(double strain_wanted, bool loading) const {
    double low = 0, high = 5e9;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high);
      (strain(middle, loading) < strain_wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  /// Area between the branches: integral of the strain over the stress, by Simpson's rule between kinks.
  double area() const {
    const auto under = [&](double a, double b, bool loading) {
      constexpr int n = 2000;
      double sum = 0;
      for (int i = 0; i < n; ++i) {
        const double s0 = a + (b - a) * i / n, s1 = a + (b - a) * (i + 1) / n;
        sum += (s1 - s0) / 6 *
               (strain(s0, loading) + 4 * strain(0.5 * (s0 + s1), loading) + strain(s1, loading));
      }
      return sum;
    };
    const auto whole = [&](bool loading) {
      const double kinks[] = {0, c * p.unloading_finish_Pa, c * p.unloading_start_Pa, c * p.loading_start_Pa,
                              c * p.loading_finish_Pa};
      double sum = 0;
      for (int i = 0; i < 4; ++i) sum += under(kinks[i], kinks[i + 1], loading);
      return sum;
    };
    return whole(false) - whole(true);
  }
};

}  // namespace

TEST(SuperelasticBar, CyclesOfTensionAndCompressionFollowTheClosedFormLoop) {
  std::printf("| set | cycle | side | largest stress error, of s_s | dissipated nJ | closed form |\n");
  std::printf("|---|---|---|---|---|---|\n");
  for (const materials::SuperelasticSet& set : materials::superelastic_sets()) {
    const double length = 3, width = 0.4, depth = 0.3, top = 0.09;
    constexpr int steps = 60;  // a ramp
    for (int elements : {1, 4}) {
      BeamScene bar(length, elements, width, depth, set.parameters, {2, 2, 2});
      bar.system.hold(0);
      for (int node = 1; node <= elements; ++node) {  // it shall not buckle
        for (int c : {1, 2}) bar.supports.fix(node, c);
        bar.supports.fix_rotation(node);
      }
      const auto strain_at = [&](double t) {  // ramps up, down, to compression, back
        const double ramp = std::fmod(t / steps, 4);
        const double height = ramp < 1 ? ramp : ramp < 3 ? 2 - ramp : ramp - 4;
        return top * height;
      };
      bar.supports.move(elements, 0, [&](double t) { return length * strain_at(t); });
      for (int cycle = 0; cycle < 2; ++cycle)
        for (int side = 0; side < 2; ++side) {
          const double sign = side == 0 ? 1 : -1;
          const Loop loop{
              set.parameters,
              sign > 0 ? 1 : set.parameters.compression_start_Pa / set.parameters.loading_start_Pa};
          const double before = bar.dissipated_nJ();
          double worst = 0;
          for (int i = 1; i <= 2 * steps; ++i) {
            const double time = (4 * cycle + 2 * side) * steps + i;
            bar.solver().advance_to(time);
            const double stress = sign * bar.solver().reactions()[elements].x() / (width * depth);
            const double strain = std::abs(strain_at(time));
            worst = std::max(worst, std::abs(stress - loop.stress(strain, i <= steps)));
          }
          const double lost = bar.dissipated_nJ() - before;
          const double expected = loop.area() * length * width * depth;
          if (elements == 1)
            std::printf("| %s | %d | %s | %.1e | %.4f | %.4f |\n", set.name.c_str(), cycle + 1,
                        sign > 0 ? "tension" : "compression", worst / set.parameters.loading_start_Pa, lost,
                        expected);
          EXPECT_LT(worst, 1e-6 * set.parameters.loading_start_Pa);
          EXPECT_NEAR(lost, expected, 1e-6 * expected);
        }
    }
  }
}

TEST(SuperelasticBar, WorkOfTheSupportIsWhatIsStoredAndDissipated) {
  const SuperelasticParameters& p = materials::superelastic_set("nitinol-62.9");
  const auto imbalance = [&](int steps) {
    BeamScene bar(3, 1, 0.4, 0.3, p, {2, 2, 2});
    bar.system.hold(0);
    for (int c : {1, 2}) bar.supports.fix(1, c);
    bar.supports.fix_rotation(1);
    bar.supports.move(1, 0, [&](double t) { return 0.15 * std::sin(1.7 * t / steps * M_PI); });
    double work = 0, place = 0, force = 0;
    for (int i = 1; i <= steps; ++i) {
      bar.solver().advance_to(i);
      const double now = bar.system.state.x[1].x() - 3, pull = bar.solver().reactions()[1].x();
      work += 0.5 * (force + pull) * (now - place);
      place = now;
      force = pull;
    }
    structure::Forces f;
    f.reset(2, 2);
    const double stored = bar.term->add_forces(bar.system.state, f);
    return std::abs(work - stored - bar.dissipated_nJ()) / bar.dissipated_nJ();
  };
  // Where the kinks of the law fall between the points of the trapezoidal sum changes its error by a factor:
  // the worst of several numbers of steps is compared.
  const auto worst = [&](int steps) {
    double most = 0;
    for (int more : {0, 3, 7, 12, 18, 25, 33, 42}) most = std::max(most, imbalance(steps + more));
    return most;
  };
  const double coarse = worst(100), fine = worst(800);
  std::printf("energy balance of the bar: %.1e of the dissipated energy with 100 steps, %.1e with 800\n",
              coarse, fine);
  EXPECT_LT(fine, 1e-4);
  EXPECT_GT(std::log2(coarse / fine) / 3, 1.7);
}

}  // namespace valsalva
