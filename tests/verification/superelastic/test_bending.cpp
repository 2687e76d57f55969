// A superelastic beam in three-point bending and under end moments, against an independent solution: moment
// and curvature of a finely layered section, integrated along the axis with large rotations.
#include <gtest/gtest.h>

#include <cmath>

#include "scenes.hpp"

namespace valsalva {
namespace {

/// One section of layers; knows its history.
class LayeredSection {
 public:
  LayeredSection(const Superelastic& law, double width, double depth, int layers)
      : law_(law), layer_area_(width * depth / layers), state_(layers) {
    for (int i = 0; i < layers; ++i) z_.push_back(depth * ((i + 0.5) / layers - 0.5));
  }
  /// Axial strain and curvature under a normal force and a moment (M > 0 stretches z > 0): the minimum of the
  /// increment's potential (stored and dissipated energy less N eps and M kappa), which is convex.
  void solve(double normal, double moment) {
    Point now = at(normal, moment, strain, curvature);
    for (int iteration = 0; iteration < 100; ++iteration) {
      const Eigen::Vector2d change = -now.tangent.inverse() * now.residual;
      double step = 1;
      Point next;
      for (int halving = 0; halving < 12; ++halving, step *= 0.5) {
        next = at(normal, moment, strain + step * change[0], curvature + step * change[1]);
        if (next.potential <= now.potential + 1e-12 * std::abs(now.potential)) break;
      }
      now = next;
      strain += step * change[0];
      curvature += step * change[1];
      if (std::abs(change[0]) < 1e-12 && std::abs(change[1]) < 1e-11) return;
    }
    ADD_FAILURE() << "the section's Newton iteration does not converge";
  }
  void accept() {
    for (std::size_t i = 0; i < z_.size(); ++i) {
      const auto s = law_.respond(state_[i], strain + z_[i] * curvature);
      lost += layer_area_ * s.dissipated_Pa;
      state_[i] = s.state;
    }
  }
  double strain = 0, curvature = 0, lost = 0;

 private:
  struct Point {
    double potential = 0;
    Eigen::Vector2d residual;
    Eigen::Matrix2d tangent = Eigen::Matrix2d::Zero();
  };
  Point at(double normal, double moment, double eps, double kappa) const {
    Point p;
    p.residual << -normal, -moment;
    p.potential = -normal * eps - moment * kappa;
    for (std::size_t i = 0; i < z_.size(); ++i) {
      const auto s = law_.respond(state_[i], eps + z_[i] * kappa);
      const Eigen::Vector2d arm(1, z_[i]);
      p.potential += layer_area_ * (s.stored_Pa + s.dissipated_Pa);
      p.residual += layer_area_ * s.state.stress_Pa * arm;
      p.tangent += layer_area_ * s.tangent_Pa * arm * arm.transpose();
    }
    return p;
  }
  const Superelastic& law_;
  double layer_area_;
  std::vector<double> z_;
  std::vector<SuperelasticState> state_;
};

/// Half of the beam: from the middle (s = 0, horizontal) to the support, which pushes with P/2.
class HalfBeam {
 public:
  HalfBeam(const Superelastic& law, double half, double width, double depth, int stations, int layers)
      : h_(half / stations), sections_(stations, LayeredSection(law, width, depth, layers)) {
    for (int i = 0; i < stations; ++i) x_.push_back(h_ * (i + 0.5));
    end_ = half;
  }
  /// Equilibrium under the load P of the middle; returns its deflection.
  double deflection(double load) {
    const double push = 0.5 * load;
    double height = 0;
    std::vector<double> slope(sections_.size(), 0.0);
    for (int iteration = 0; iteration < 100; ++iteration) {
      double change = 0, x = 0, z = 0, angle = 0;
      for (std::size_t i = 0; i < sections_.size(); ++i) {
        LayeredSection& s = sections_[i];
        // Lower side (z < 0 of the section) is stretched: the moment bends the ends up.
        s.solve(push * std::sin(slope_[i]), -push * (end_ - x_[i]));
        const double middle = angle - 0.5 * h_ * s.curvature;
        const double stretch = (1 + s.strain) * h_;
        const double here = x + 0.5 * stretch * std::cos(middle);
        slope[i] = middle;
        change = std::max({change, std::abs(here - x_[i]), std::abs(middle - slope_[i])});
        x_[i] = here;
        x += stretch * std::cos(middle);
        z += stretch * std::sin(middle);
        angle -= h_ * s.curvature;
      }
      slope_ = slope;
      change = std::max(change, std::abs(x - end_));
      end_ = x;
      height = z;
      if (change < 1e-9) break;
      if (iteration == 99) ADD_FAILURE() << "the reference does not converge, change " << change;
    }
    for (LayeredSection& s : sections_) s.accept();
    return height;
  }
  double dissipated_nJ() const {
    double sum = 0;
    for (const LayeredSection& s : sections_) sum += 2 * h_ * s.lost;
    return sum;
  }

 private:
  double h_, end_;
  std::vector<LayeredSection> sections_;
  std::vector<double> x_;
  std::vector<double> slope_ = std::vector<double>(sections_.size(), 0.0);
};

constexpr double length = 12, width = 0.4, depth = 0.3;
constexpr int steps = 20;  // up, and as many down
constexpr double full_load = 1.75e6;

double load_at(double t) {
  return full_load * (t <= steps ? t : 2 * steps - t) / steps;
}

struct Curve {
  std::vector<double> deflection;
  double dissipated = 0, martensite = 0;
};

Curve reference(const Superelastic& law, int stations, int layers) {
  HalfBeam beam(law, 0.5 * length, width, depth, stations, layers);
  Curve curve;
  for (int i = 1; i <= 2 * steps; ++i) curve.deflection.push_back(beam.deflection(load_at(i)));
  curve.dissipated = beam.dissipated_nJ();
  return curve;
}

Curve three_point(const SuperelasticParameters& alloy, int elements, structure::FibreGrid grid,
                  double sign = 1) {
  BeamScene beam(length, elements, width, depth, alloy, grid);
  const int middle = elements / 2;
  for (int end : {0, elements}) {
    beam.supports.fix(end, 1);
    beam.supports.fix(end, 2);
    beam.supports.fix_rotation(end, 0);
  }
  beam.supports.fix(middle, 0);
  Points force(elements + 1, Vec3::Zero());
  force[middle] = Vec3(0, 0, -sign);
  beam.load(force, {}, load_at);
  Curve curve;
  for (int i = 1; i <= 2 * steps; ++i) {
    beam.solver().advance_to(i);
    curve.deflection.push_back(-sign * beam.system.state.x[middle].z());
    curve.martensite = std::max(curve.martensite, beam.term->largest_martensite());
  }
  curve.dissipated = beam.dissipated_nJ();
  return curve;
}

double difference(const Curve& a, const Curve& b) {
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < a.deflection.size(); ++i) {
    worst = std::max(worst, std::abs(a.deflection[i] - b.deflection[i]));
    largest = std::max(largest, std::abs(b.deflection[i]));
  }
  return worst / largest;
}

/// Largest difference of the load while loading, at the deflections of `a`, over the full load.
double load_difference(const Curve& a, const Curve& b) {
  double worst = 0;
  for (int i = 0; i < steps; ++i) {
    int j = 0;
    while (j + 1 < steps && b.deflection[j] < a.deflection[i]) ++j;
    const double before = j > 0 ? b.deflection[j - 1] : 0;
    const double load = load_at(j) + (a.deflection[i] - before) / (b.deflection[j] - before) * load_at(1);
    worst = std::max(worst, std::abs(load - load_at(i + 1)));
  }
  return worst / full_load;
}

}  // namespace

TEST(SuperelasticBeam, ThreePointBendingAgainstIntegratedSections) {
  const SuperelasticParameters& alloy = materials::superelastic_set("nitinol-62.9");
  const Superelastic law(alloy);
  const Curve exact = reference(law, 120, 120), coarser = reference(law, 60, 60);
  std::printf("reference: %.5f mm at %.2f N, dissipated %.1f nJ; itself converged to %.1e\n",
              exact.deflection[steps - 1], 1e-6 * full_load, exact.dissipated, difference(coarser, exact));
  const Curve beam = three_point(alloy, 64, {2, 20, 2});
  std::printf(
      "| load N | loading: beam mm | sections mm | unloading: beam mm | sections mm "
      "|\n|---|---|---|---|---|\n");
  for (int i : {3, 7, 11, 15, 19}) {
    const int back = 2 * steps - 2 - i;
    std::printf("| %.3f | %.5f | %.5f | %.5f | %.5f |\n", 1e-6 * load_at(i + 1), beam.deflection[i],
                exact.deflection[i], beam.deflection[back], exact.deflection[back]);
  }
  std::printf("largest fraction of martensite %.2f; dissipated %.2f nJ, sections %.2f\n", beam.martensite,
              beam.dissipated, exact.dissipated);
  EXPECT_GT(beam.martensite, 0.5);
  EXPECT_LT(difference(beam, exact), 0.005);
  EXPECT_NEAR(beam.dissipated, exact.dissipated, 0.01 * exact.dissipated);
  EXPECT_LT(std::abs(beam.deflection.back()), 1e-7 * length);  // nothing is left

  // The plateau makes deflection under a load sensitive; the load at a deflection, which is what matters to a
  // crimped frame, is less so.
  std::printf(
      "| elements of the beam | deflection at equal load, of the largest | load at equal deflection |\n");
  std::printf("|---|---|---|\n");
  double coarse = 0, last = 0;
  for (int elements : {4, 8, 16, 32, 64}) {
    const Curve curve = three_point(alloy, elements, {2, 20, 2});
    last = difference(curve, exact);
    if (elements == 16) coarse = last;
    std::printf("| %d | %.2e | %.2e |\n", elements, last, load_difference(curve, exact));
  }
  EXPECT_LT(last, 0.005);
  EXPECT_GT(std::log2(coarse / last) / 2, 1.5);
  std::printf("| fibres over the depth | difference, 32 elements |\n|---|---|\n");
  double few = 0, many = 0;
  for (int fibres : {2, 3, 4, 5, 6, 8, 10, 20}) {
    const double error = difference(three_point(alloy, 32, {2, fibres, 2}), exact);
    std::printf("| %d | %.2e |\n", fibres, error);
    if (fibres == 3) few = error;
    if (fibres == 10) many = error;
  }
  EXPECT_LT(many, 0.5 * few);
  std::printf("| stations of an element | difference, 8 elements |\n|---|---|\n");
  for (int stations : {2, 3, 4})
    std::printf("| %d | %.2e |\n", stations, difference(three_point(alloy, 8, {2, 20, stations}), exact));
}

TEST(SuperelasticBeam, UpAndDownAreMirrorImages) {
  const SuperelasticParameters& alloy = materials::superelastic_set("nitinol-62.9");
  const Curve down = three_point(alloy, 8, {2, 6, 2}), up = three_point(alloy, 8, {2, 6, 2}, -1);
  EXPECT_LT(difference(down, up), 1e-8);
}

TEST(SuperelasticBeam, EndMomentStretchesTheAxisOnlyWhenTheLawIsAsymmetric) {
  SuperelasticParameters alloy = materials::superelastic_set("nitinol-62.9");
  std::printf("| compression / tension | axial strain of the axis | section | curvature 1/mm | section |\n");
  std::printf("|---|---|---|---|---|\n");
  for (double ratio : {1.0, 1.5}) {
    alloy.compression_start_Pa = ratio * alloy.loading_start_Pa;
    const Superelastic law(alloy);
    const double moment = 1.25 * alloy.loading_start_Pa * width * depth * depth / 6;
    LayeredSection section(law, width, depth, 4000);
    for (int i = 1; i <= 10; ++i) {
      section.solve(0, moment * i / 10);
      section.accept();
    }
    constexpr int elements = 16;
    BeamScene beam(4, elements, width, depth, alloy, {2, 20, 2});
    beam.system.hold(0);
    Points moments(elements + 1, Vec3::Zero());
    moments[elements] = Vec3(0, moment, 0);  // turns x towards -z: stretches z > 0
    beam.load({}, moments, [](double t) { return t / 10; });
    beam.solver().advance_to(10);
    double chord = 0;
    for (int i = 0; i < elements; ++i) chord += (beam.system.state.x[i + 1] - beam.system.state.x[i]).norm();
    const auto& q = beam.system.state.rotation[elements];
    const double turn = 2 * std::atan2(q.vec().norm(), q.w());
    // The chord of an arc of angle a an element is shorter by a factor sin(a/2)/(a/2): to its second order.
    const double a = turn / elements;
    const double strain = chord / 4 - 1, curvature = turn / 4;
    std::printf("| %.1f | %.3e | %.3e | %.5f | %.5f |\n", ratio, strain, section.strain, curvature,
                section.curvature);
    EXPECT_NEAR(curvature, section.curvature, 0.005 * section.curvature);
    EXPECT_NEAR(strain, section.strain, 0.02 * std::abs(section.strain) + a * a / 24);
    if (ratio == 1)
      EXPECT_LT(std::abs(strain), 1e-9);
    else
      EXPECT_GT(strain, 1e-4);
  }
}

}  // namespace valsalva
