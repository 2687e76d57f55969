#include "drape.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"

namespace valsalva::stent {

namespace {

struct Spring {
  int a, b;
  double length, stiffness;  // stiffness relative to length: force k (l - L) / L
};

std::vector<Spring> springs_of(const Points& flat, const std::vector<Triangle>& triangles, double bending,
                               std::size_t& edges) {
  std::map<Edge, std::vector<int>> opposite;
  for (const Triangle& t : triangles)
    for (int c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      opposite[{std::min(a, b), std::max(a, b)}].push_back(t[(c + 2) % 3]);
    }
  std::vector<Spring> springs;
  for (const auto& [edge, corner] : opposite)
    springs.push_back({edge[0], edge[1], (flat[edge[0]] - flat[edge[1]]).norm(), 1.0});
  edges = springs.size();
  for (const auto& [edge, corner] : opposite)
    if (corner.size() == 2)
      springs.push_back({corner[0], corner[1], (flat[corner[0]] - flat[corner[1]]).norm(), bending});
  return springs;
}

class Forces {
 public:
  Forces(const std::vector<Spring>& springs, const std::vector<bool>& held, const Profile& inside,
         const DrapeSettings& settings)
      : springs_(springs), held_(held), inside_(inside), clearance_(settings.clearance_mm) {
    for (int side : {-1, 1})
      walls_.push_back(Vec3(std::sin(settings.half_angle), -side * std::cos(settings.half_angle), 0));
  }

  void operator()(const Points& x, Points& f) const {
    std::fill(f.begin(), f.end(), Vec3::Zero());
    for (const Spring& s : springs_) {
      const Vec3 along = x[s.b] - x[s.a];
      const double length = along.norm();
      const Vec3 pull = s.stiffness * (length / s.length - 1) / std::max(length, 1e-12) * along;
      f[s.a] += pull;
      f[s.b] -= pull;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (held_[i]) {
        f[i].setZero();
        continue;
      }
      const double r = std::hypot(x[i].x(), x[i].y()), beyond = r - inside_.radius(x[i].z());
      if (beyond > 0) f[i] -= beyond / r * Vec3(x[i].x(), x[i].y(), 0);
      for (const Vec3& normal : walls_) {
        const double room = normal.dot(x[i]) - clearance_;
        if (room < 0) f[i] -= room * normal;
      }
    }
  }

 private:
  const std::vector<Spring>& springs_;
  const std::vector<bool>& held_;
  const Profile& inside_;
  double clearance_;
  std::vector<Vec3> walls_;
};

}  // namespace

Draped drape(const Points& flat, const std::vector<Triangle>& triangles, const std::vector<bool>& held,
             Points start, const Profile& inside, const DrapeSettings& settings) {
  std::size_t edges = 0;
  const std::vector<Spring> springs = springs_of(flat, triangles, settings.bending, edges);
  double shortest = 1e30;
  for (std::size_t s = 0; s < edges; ++s) shortest = std::min(shortest, springs[s].length);
  const Forces forces(springs, held, inside, settings);

  Draped result;
  Points& x = result.points = std::move(start);
  Points v(x.size(), Vec3::Zero()), f(x.size());
  // Unit masses: a spring of force l/L - 1 has the stiffness 1/L; about ten act on a node.
  const double longest_step = 0.5 * std::sqrt(shortest / 10);
  double step = 0.1 * longest_step, mixing = 0.1;
  int downhill = 0;
  for (result.iterations = 0;; ++result.iterations) {
    forces(x, f);
    double power = 0, speed2 = 0, force2 = 0, largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      power += f[i].dot(v[i]), speed2 += v[i].squaredNorm(), force2 += f[i].squaredNorm();
      largest = std::max(largest, f[i].norm());
    }
    if (!std::isfinite(force2))
      throw NumericalFailure("draping a leaflet diverged after {} steps", result.iterations);
    if (largest < settings.tolerance || result.iterations >= settings.most_iterations) break;
    if (power > 0) {
      if (++downhill > 5) step = std::min(1.1 * step, longest_step), mixing *= 0.99;
      const double scale = std::sqrt(speed2 / force2);
      for (std::size_t i = 0; i < x.size(); ++i) v[i] = (1 - mixing) * v[i] + mixing * scale * f[i];
    } else {
      downhill = 0, step *= 0.5, mixing = 0.1;
      std::fill(v.begin(), v.end(), Vec3::Zero());
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      v[i] += step * f[i];
      x[i] += step * v[i];
    }
  }
  for (std::size_t s = 0; s < edges; ++s)
    result.largest_edge_strain =
        std::max(result.largest_edge_strain,
                 std::abs((x[springs[s].a] - x[springs[s].b]).norm() / springs[s].length - 1));
  return result;
}

}  // namespace valsalva::stent
