#include "assembly/valve_shapes.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::assembly {
namespace {

constexpr double rad_per_deg = M_PI / 180;

double along(const std::array<double, 2>& part, double u) {
  return part[0] + u * (part[1] - part[0]);
}

double attachment_z(const ValveShape& v, double s) {
  return v.height * std::pow(std::abs(s), v.exponent);
}

Vec3 on_tube(const ValveShape& v, double s, double z) {
  const double a = s * v.half_angle_deg * rad_per_deg;
  return {v.radius * std::cos(a), v.radius * std::sin(a), z};
}

Vec3 free_edge(const ValveShape& v, double s) {
  const double half = v.half_angle_deg * rad_per_deg;
  const double half_chord = v.radius * std::sin(half), sagitta = v.radius * std::cos(half) - v.gap;
  const double rise = v.peak * std::pow(std::cos(0.5 * M_PI * s), 2);
  const double z = v.height + v.post + rise;
  if (std::abs(sagitta) < 1e-9 * v.radius) return {v.gap, half_chord * s, z};
  const double bow = (half_chord * half_chord + sagitta * sagitta) / (2 * sagitta);
  const double t = s * 2 * std::atan(sagitta / half_chord);
  return {v.gap + bow * (1 - std::cos(t)), bow * std::sin(t), z};
}

}  // namespace

void check_valve(const ValveShape& v, const std::string& what) {
  if (!(v.height > 0) || !(v.post > 0))
    throw InputError("{}: height {} and post {} mm; expected both positive", what, v.height, v.post);
  const double chord = v.radius * std::cos(v.half_angle_deg * rad_per_deg);
  if (!(v.gap >= 0) || !(v.gap <= chord))
    throw InputError(
        "{}: gap is {} mm; expected between 0 and {:.4g} mm, the distance of the commissures' chord from the "
        "axis",
        what, v.gap, chord);
}

Map leaflet_map(const Frame& frame, const ValveShape& v, std::array<double, 2> part) {
  const auto middle = [=](double s, double t) {
    return Vec3((1 - t) * on_tube(v, s, attachment_z(v, s)) + t * free_edge(v, s));
  };
  return [=](const Vec3& u) {
    const double s = along(part, u.x());
    Vec3 x = middle(s, u.y());
    if (v.wall > 0 && u.z() > 0) {
      // One-sided inside the leaflet, so that halves of it meet in the same normal at the symmetry plane.
      const double step = 1e-5, left = std::max(s - step, -1.0), right = std::min(s + step, 1.0);
      const Vec3 du = middle(right, u.y()) - middle(left, u.y());
      const Vec3 dv = middle(s, std::min(u.y() + step, 1.0)) - middle(s, std::max(u.y() - step, 0.0));
      x += u.z() * v.wall * du.cross(dv).normalized();
    }
    return frame.at(x);
  };
}

Map crown_map(const Frame& frame, const ValveShape& v, std::array<double, 2> part) {
  return [=](const Vec3& u) {
    const double s = along(part, u.x());
    const double z = -v.base + u.y() * (attachment_z(v, s) + v.base);
    Vec3 x = on_tube(v, s, z);
    const double outer = 1 + u.z() * v.wall / v.radius;
    x.head<2>() *= outer;
    return frame.at(x);
  };
}

}  // namespace valsalva::assembly
