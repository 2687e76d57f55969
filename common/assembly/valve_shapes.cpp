#include "assembly/valve_shapes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

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
  if (v.edge_exponent > 0) {
    const double inwards = std::pow(std::max(0.0, std::cos(0.5 * M_PI * s)), v.edge_exponent);
    const double r = v.radius - (v.radius - v.gap) * inwards;
    return {r * std::cos(s * half), r * std::sin(s * half), z};
  }
  if (std::abs(sagitta) < 1e-9 * v.radius) return {v.gap, half_chord * s, z};
  const double bow = (half_chord * half_chord + sagitta * sagitta) / (2 * sagitta);
  const double t = s * 2 * std::atan(sagitta / half_chord);
  return {v.gap + bow * (1 - std::cos(t)), bow * std::sin(t), z};
}

/// A curve in the (s, z) plane, to be walked through evenly by its length; s counts as `width` mm.
class Curve {
 public:
  using Function = std::function<Eigen::Vector2d(double)>;
  Curve(double width, Function at) : at_(std::move(at)) {
    Eigen::Vector2d before = at_(0);
    for (int i = 1; i <= pieces; ++i) {
      const Eigen::Vector2d now = at_(static_cast<double>(i) / pieces), step = now - before;
      length_.push_back(length_.back() + std::hypot(width * step.x(), step.y()));
      before = now;
    }
  }
  Eigen::Vector2d at(double share) const {
    const double wanted = share * length_.back();
    const auto next = std::upper_bound(length_.begin() + 1, length_.end() - 1, wanted);
    const auto i = next - length_.begin();
    const double within = (wanted - length_[i - 1]) / (length_[i] - length_[i - 1]);
    return at_((static_cast<double>(i - 1) + within) / pieces);
  }

 private:
  static constexpr int pieces = 400;
  Function at_;
  std::vector<double> length_{0};
};

/// The leaflet as a patch with four sides in the (s, z) plane: below, the middle of the attachment; at the
/// sides, its steep parts with the commissures (or the cuts of a part); above, the free edge. Inside, the
/// harmonic map of the square (one to one, as the region is all but convex): where two sides meet in a
/// straight line it keeps the elements open, which blending between the sides would not.
class Outline {
 public:
  Outline(const ValveShape& v, std::array<double, 2> part)
      : left_corner_(part[0] > -1 ? part[0] : std::min(-corner, part[1])),
        right_corner_(part[1] < 1 ? part[1] : std::max(corner, part[0])),
        low_(width(v),
             [=, this](double u) { return attached(v, left_corner_ + u * (right_corner_ - left_corner_)); }),
        high_(width(v), [=](double u) { return on_edge(v, part[0] + u * (part[1] - part[0])); }),
        left_(width(v), [=, this](double u) { return side(v, part[0], left_corner_, u); }),
        right_(width(v), [=, this](double u) { return side(v, part[1], right_corner_, u); }),
        inside_((cells + 1) * (cells + 1)) {
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) node(i, j) = blended(share(i), share(j));
    constexpr double relaxation = 1.9;  // of Gauss and Seidel's iteration
    for (int sweep = 0; sweep < 300; ++sweep)
      for (int j = 1; j < cells; ++j)
        for (int i = 1; i < cells; ++i) {
          const Eigen::Vector2d mean =
              0.25 * (node(i - 1, j) + node(i + 1, j) + node(i, j - 1) + node(i, j + 1));
          node(i, j) += relaxation * (mean - node(i, j));
        }
  }

  Eigen::Vector2d at(double u, double w) const {
    if (u <= 0) return left_.at(w);
    if (u >= 1) return right_.at(w);
    if (w <= 0) return low_.at(u);
    if (w >= 1) return high_.at(u);
    const int i = std::min(static_cast<int>(u * cells), cells - 1),
              j = std::min(static_cast<int>(w * cells), cells - 1);
    const double a = u * cells - i, b = w * cells - j;
    return (1 - b) * ((1 - a) * node(i, j) + a * node(i + 1, j)) +
           b * ((1 - a) * node(i, j + 1) + a * node(i + 1, j + 1));
  }

 private:
  static constexpr double corner = 0.55;  // where on the attachment, in units of s, its steep part begins
  static double width(const ValveShape& v) { return v.radius * v.half_angle_deg * rad_per_deg; }
  static Eigen::Vector2d attached(const ValveShape& v, double s) { return {s, attachment_z(v, s)}; }
  static Eigen::Vector2d on_edge(const ValveShape& v, double s) { return {s, free_edge(v, s).z()}; }
  /// From the corner of the attachment to the free edge, along the attachment or straight up a cut.
  static Eigen::Vector2d side(const ValveShape& v, double end, double from, double u) {
    if (std::abs(end) < 1) return (1 - u) * attached(v, end) + u * on_edge(v, end);
    constexpr double bend = 0.8;  // share of the parameter for the attachment, the rest for the commissure
    if (u < bend) return attached(v, from + u / bend * (end - from));
    return attached(v, end) + (u - bend) / (1 - bend) * (on_edge(v, end) - attached(v, end));
  }

  /// Coons' patch (1967).
  Eigen::Vector2d blended(double u, double w) const {
    return (1 - w) * low_.at(u) + w * high_.at(u) + (1 - u) * left_.at(w) + u * right_.at(w) -
           (1 - u) * (1 - w) * low_.at(0) - u * (1 - w) * low_.at(1) - (1 - u) * w * high_.at(0) -
           u * w * high_.at(1);
  }
  static constexpr int cells = 48;
  static double share(int i) { return static_cast<double>(i) / cells; }
  Eigen::Vector2d& node(int i, int j) { return inside_[j * (cells + 1) + i]; }
  const Eigen::Vector2d& node(int i, int j) const { return inside_[j * (cells + 1) + i]; }

  double left_corner_, right_corner_;
  Curve low_, high_, left_, right_;
  std::vector<Eigen::Vector2d> inside_;
};

}  // namespace

void check_valve(const ValveShape& v, const std::string& what) {
  if (!(v.height > 0) || !(v.post > 0))
    throw InputError("{}: height {} and post {} mm; expected both positive", what, v.height, v.post);
  const double chord = v.edge_exponent > 0 ? v.radius : v.radius * std::cos(v.half_angle_deg * rad_per_deg);
  if (!(v.gap >= 0) || !(v.gap <= chord))
    throw InputError(
        "{}: gap is {} mm; expected between 0 and {:.4g} mm, the distance of the commissures' chord from the "
        "axis (with free_edge_exponent: the radius)",
        what, v.gap, chord);
}

Map leaflet_map(const Frame& frame, const ValveShape& v, std::array<double, 2> part) {
  const auto middle = [=](double s, double t) {
    return Vec3((1 - t) * on_tube(v, s, attachment_z(v, s)) + t * free_edge(v, s));
  };
  const auto outline = std::make_shared<const Outline>(v, part);
  return [=](const Vec3& u) {
    const Eigen::Vector2d flat = outline->at(u.x(), u.y());
    const double s = std::clamp(flat.x(), -1.0, 1.0);
    const double low = attachment_z(v, s), high = free_edge(v, s).z();
    const double t = std::clamp((flat.y() - low) / (high - low), 0.0, 1.0);
    Vec3 x = middle(s, t);
    if (v.wall > 0 && u.z() > 0) {
      const double step = 1e-5, left = std::max(s - step, -1.0), right = std::min(s + step, 1.0);
      const Vec3 du = middle(right, t) - middle(left, t);
      const Vec3 dv = middle(s, std::min(t + step, 1.0)) - middle(s, std::max(t - step, 0.0));
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
