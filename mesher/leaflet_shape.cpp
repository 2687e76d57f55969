#include "leaflet_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::mesher {
namespace {

constexpr double crown_width_power = 2.0;
constexpr double crown_height_power = 2.7;
constexpr double blunt_tip = 0.12;    ///< |u| within which the free edge keeps its least radius
constexpr double inward_turn = 0.75;  ///< |u| beyond which it follows the wall
constexpr double wedge_deg = 14;      ///< angle between free edge and wall at a commissure
constexpr double clearance_fraction =
    0.12;                                  ///< largest distance to the wall where the edge follows it, of R_c
constexpr double least_mid_radius = 0.05;  ///< of R_c, before rounding
constexpr double largest_mid_radius = 0.75;  ///< of R_c
constexpr double edge_rounding = 0.05;       ///< width of the Gaussian that rounds the free edge, of 2 R_n
constexpr double least_clearance_mm = 0.3;   ///< away from the attachment
constexpr int edge_samples = 400;

/// 0 at 0, 1 from 1 on; twice continuously differentiable.
double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (6 * x - 15));
}

}  // namespace

double commissure_height(const LeafletProportions& p) {
  return std::min(p.commissure_height_factor * p.annulus_diameter_mm, p.junction_z_mm);
}

double crown_height(double x) {
  return 1 - std::pow(1 - std::pow(std::min(1.0, std::abs(x)), crown_width_power), 1 / crown_height_power);
}

LeafletShape::LeafletShape(const Root& root, const LeafletProportions& p, double from, double to)
    : root_(root), inset_(p.attachment_inset_mm), middle_(0.5 * (from + to)) {
  const double d = p.annulus_diameter_mm;
  const double height = commissure_height(p);
  sizes_.commissure_z_mm = height;
  commissure_radius_ = 0.5 * (root.wall_radius(from, height) + root.wall_radius(to, height));
  half_width_ = 0.5 * (to - from) - 0.5 * p.commissure_gap_mm / commissure_radius_;
  nadir_radius_ = root.wall_radius(middle_, 0);

  const double slack = 1 + p.free_edge_excess;
  const double coaptation = p.coaptation_height_factor * d;
  const double closed_edge = std::max(p.free_edge_factor * d, 2 * slack * commissure_radius_);
  sizes_.free_edge_mm = closed_edge / p.closed_stretch;
  const double straight = 0.5 * closed_edge / slack;
  const double edge_z =
      height - std::sqrt(std::max(0.0, straight * straight - commissure_radius_ * commissure_radius_));
  const double contact_z = std::max(0.0, edge_z - coaptation);
  sizes_.peak_mm = p.free_edge_peak_factor * d;
  sizes_.length_mm = slack * (std::hypot(nadir_radius_, contact_z) + coaptation) + sizes_.peak_mm;
  design_length_ = sizes_.length_mm;
  for (int pass = 0; pass < 4; ++pass) {
    fit_mid_radius();
    design_length_ += sizes_.length_mm - straight_length_mm();
  }
}

LeafletShape::Cylindrical LeafletShape::attachment_at(double u) const {
  const double z = sizes_.commissure_z_mm * crown_height(u);
  return {root_.wall_radius(angle(u), z) + inset_, z};
}

LeafletShape::Cylindrical LeafletShape::free_edge_at(double u) const {
  const double height = sizes_.commissure_z_mm;
  const double reach = nadir_radius_ - mid_radius_;
  const double plain_length = design_length_ - sizes_.peak_mm;
  const double full_z = std::sqrt(std::max(0.0, design_length_ * design_length_ - reach * reach));
  const double plain_z = std::sqrt(std::max(0.0, plain_length * plain_length - reach * reach));
  const double w = 1 - u * u;
  const double z = height + (plain_z - height) * w + (full_z - plain_z) * w * w * w * w;

  const double from_commissure = (1 - std::abs(u)) * half_width_ * commissure_radius_;
  const double clearance = std::min(clearance_fraction * commissure_radius_,
                                    from_commissure * std::tan(wedge_deg * std::numbers::pi / 180));
  const double follow =
      root_.wall_radius(angle(u), z) - clearance + inset_ * std::max(0.0, 1 - from_commissure);
  return {mid_radius_ +
              (follow - mid_radius_) * smooth_step((std::abs(u) - blunt_tip) / (inward_turn - blunt_tip)),
          z};
}

Vec3 LeafletShape::attachment(double u) const {
  const auto [radius, z] = attachment_at(u);
  return root_.position(angle(u), radius, z);
}

Vec3 LeafletShape::free_edge(double u) const {
  if (std::abs(u) >= 1) return attachment(u);
  const auto after = std::upper_bound(edge_u_.begin(), edge_u_.end(), u) - edge_u_.begin();
  const double f = (u - edge_u_[after - 1]) / (edge_u_[after] - edge_u_[after - 1]);
  return edge_[after - 1] + f * (edge_[after] - edge_[after - 1]);
}

/// The course of free_edge_at in equal steps, rounded by a Gaussian along the arc with fixed ends.
void LeafletShape::trace_free_edge() {
  constexpr int raw_samples = 1200;
  std::vector<double> u, arc{0};
  Points raw;
  for (int i = 0; i <= raw_samples; ++i) {
    u.push_back(-1 + 2.0 * i / raw_samples);
    const auto [radius, z] = free_edge_at(u.back());
    raw.push_back(i == 0 || i == raw_samples ? attachment(u.back())
                                             : root_.position(angle(u.back()), radius, z));
    if (i > 0) arc.push_back(arc.back() + (raw[i] - raw[i - 1]).norm());
  }
  edge_.assign(1, raw.front());
  edge_u_.assign(1, -1.0);
  for (int k = 1, i = 1; k < edge_samples; ++k) {
    const double target = arc.back() * k / edge_samples;
    while (arc[i] < target) ++i;
    const double f = (target - arc[i - 1]) / (arc[i] - arc[i - 1]);
    edge_.push_back(raw[i - 1] + f * (raw[i] - raw[i - 1]));
    edge_u_.push_back(u[i - 1] + f * (u[i] - u[i - 1]));
  }
  edge_.push_back(raw.back());
  edge_u_.push_back(1);

  const double step = arc.back() / edge_samples;
  const double rounding = edge_rounding * 2 * nadir_radius_;
  const int sweeps = static_cast<int>(2 * rounding * rounding / (step * step));
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    Vec3 before = edge_.front();
    for (int k = 1; k < edge_samples; ++k) {
      const Vec3 here = edge_[k];
      edge_[k] = 0.25 * (before + 2 * here + edge_[k + 1]);
      before = here;
    }
  }
}

double LeafletShape::free_edge_length() const {
  double sum = 0;
  for (std::size_t i = 1; i < edge_.size(); ++i) sum += (edge_[i] - edge_[i - 1]).norm();
  return sum;
}

/// The edge grows as its middle moves towards the axis.
void LeafletShape::fit_mid_radius() {
  double low = least_mid_radius * commissure_radius_;
  double high = std::min(largest_mid_radius * commissure_radius_, 0.95 * nadir_radius_);
  for (int i = 0; i < 25; ++i) {
    mid_radius_ = 0.5 * (low + high);
    trace_free_edge();
    (free_edge_length() > sizes_.free_edge_mm ? low : high) = mid_radius_;
  }
}

/// The same height and angle, but at most as far out as the wall less a clearance that grows from the
/// attachment.
Vec3 LeafletShape::off_the_wall(const Vec3& x, double from_attachment) const {
  const double clearance = std::min(least_clearance_mm, 0.08 * from_attachment);
  const double furthest = root_.wall_radius(root_.angle_of(x), x.z()) + inset_ - clearance;
  return root_.radius_of(x) <= furthest ? x : root_.position(root_.angle_of(x), furthest, x.z());
}

/// Equal steps of the faster of attachment and free edge.
std::vector<double> LeafletShape::columns(int count) const {
  constexpr int fine = 2000;
  const auto fine_u = [](int i) { return -std::cos(std::numbers::pi * i / fine); };
  std::vector<double> advance{0};
  for (int i = 1; i <= fine; ++i)
    advance.push_back(advance.back() + std::max((attachment(fine_u(i)) - attachment(fine_u(i - 1))).norm(),
                                                (free_edge(fine_u(i)) - free_edge(fine_u(i - 1))).norm()));
  std::vector<double> u{-1};
  for (int i = 1, k = 1; k < count; ++k) {
    const double target = advance.back() * k / count;
    while (advance[i] < target) ++i;
    const double f = (target - advance[i - 1]) / (advance[i] - advance[i - 1]);
    u.push_back(fine_u(i - 1) + f * (fine_u(i) - fine_u(i - 1)));
  }
  u.push_back(1);
  return u;
}

geometry::TriMesh LeafletShape::sampled(int across, int along) const {
  geometry::TriMesh mesh;
  // Commissures are single points; the columns between them run from attachment to free edge.
  mesh.points = {attachment(-1), attachment(1)};
  const auto node = [&](int i, int j) {
    if (i == 0) return 0;
    if (i == across) return 1;
    return 2 + (i - 1) * (along + 1) + j;
  };
  const auto u = columns(across);
  for (int i = 1; i < across; ++i) {
    const Vec3 low = attachment(u[i]), way = free_edge(u[i]) - low;
    mesh.points.push_back(low);
    for (int j = 1; j <= along; ++j)
      mesh.points.push_back(off_the_wall(low + way * j / along, way.norm() * j / along));
  }
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < along; ++j) {
      const int a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), e = node(i, j + 1);
      if (a != e && b != c) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, e});
      } else {
        mesh.triangles.push_back(a == e ? Triangle{a, b, c} : Triangle{a, b, e});
      }
    }
  return mesh;
}

}  // namespace valsalva::mesher
