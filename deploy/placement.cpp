#include "placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"

namespace valsalva::deploy {
namespace {

double strut_radius(const structure::BeamNetwork& network) {
  const auto& depth = network.mesh().depth_mm;
  return 0.5 * *std::max_element(depth.begin(), depth.end());
}

double mean_z(const Points& x, const std::vector<int>& nodes) {
  double sum = 0;
  for (int a : nodes) sum += x[a].z();
  return sum / static_cast<double>(nodes.size());
}

std::vector<int> lowest(const Points& x, double band) {
  double low = std::numeric_limits<double>::infinity();
  for (const Vec3& p : x) low = std::min(low, p.z());
  std::vector<int> nodes;
  for (std::size_t a = 0; a < x.size(); ++a)
    if (x[a].z() < low + band) nodes.push_back(static_cast<int>(a));
  return nodes;
}

// Centre of the lumen's cross-section at a height, by the samples inside it.
Vec3 lumen_centre(const geometry::GridSdf& wall, double z) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (int j = 0; j < wall.dimensions[1]; ++j)
    for (int i = 0; i < wall.dimensions[0]; ++i) {
      const Vec3 x(wall.origin.x() + wall.spacing * i, wall.origin.y() + wall.spacing * j, z);
      if (wall.value(x) < 0) {
        sum += x;
        count += 1;
      }
    }
  return count > 0 ? Vec3(sum / count) : Vec3(0, 0, z);
}

// How deep the crimped struts would stand in the wall; negative when they are clear.
double overlap(const Inputs& in, const Eigen::Isometry3d& to_world, double radius) {
  double worst = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : in.frame.points) worst = std::max(worst, in.wall.value(to_world * p) + radius);
  return worst;
}

}  // namespace

std::vector<int> inflow_nodes(const FrameBody& frame) {
  return lowest(frame.network->mesh().reference, 0.1);
}

std::vector<int> skirt_edge_nodes(const ShellBody& skirt) {
  return lowest(skirt.mounted, 0.1);
}

const ShellBody* find(const std::vector<ShellBody>& bodies, const std::string& name) {
  for (const ShellBody& body : bodies)
    if (body.name == name) return &body;
  return nullptr;
}

Placement place(const Inputs& in, const Parameters& p) {
  Placement out;
  const double strut = strut_radius(*in.frame.network);
  const ShellBody* skirt = find(in.tissue, "skirt");
  const double edge = skirt ? mean_z(skirt->points, skirt_edge_nodes(*skirt))
                            : mean_z(in.frame.points, inflow_nodes(in.frame));

  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3& x : in.frame.points) {
    out.radius_mm = std::max(out.radius_mm, std::hypot(x.x(), x.y()) + strut);
    low = std::min(low, x.z());
    high = std::max(high, x.z());
  }
  const double shift = -p.depth_mm - edge;
  out.low_mm = low + shift;
  out.high_mm = high + shift;
  const Vec3 aim = lumen_centre(in.wall, out.high_mm).normalized();
  const Eigen::Quaterniond full = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), aim);
  double worst = 0;
  for (int tenth = 0; tenth <= 10; ++tenth) {
    const Eigen::Quaterniond tilt = Eigen::Quaterniond::Identity().slerp(0.1 * tenth, full);
    out.to_world =
        tilt * Eigen::Translation3d(0, 0, shift) * Eigen::AngleAxisd(p.rotation_rad, Vec3::UnitZ());
    out.tilt_deg = 2 * std::acos(std::min(1.0, std::abs(tilt.w()))) * 180 / M_PI;
    worst = overlap(in, out.to_world, strut);
    if (worst < 0) return out;
  }
  throw InputError(
      "the crimped device (radius {:.2f} mm, heights {:.1f} to {:.1f} mm) does not fit into the lumen: it "
      "would stand {:.2f} mm in the wall; choose a smaller device, another deploy.depth_mm, or check the "
      "anatomy's lumen there",
      out.radius_mm, out.low_mm, out.high_mm, worst);
}

void apply(const Placement& placement, Inputs& in) {
  const Eigen::Isometry3d& to_world = placement.to_world;
  const Eigen::Quaterniond turn(to_world.rotation());
  for (Vec3& x : in.frame.points) x = to_world * x;
  for (Points* vectors : {&in.frame.velocity, &in.frame.angular_velocity})
    for (Vec3& v : *vectors) v = turn * v;
  for (Eigen::Quaterniond& q : in.frame.rotation) q = (turn * q).normalized();
  for (ShellBody& body : in.tissue) {
    for (Vec3& x : body.points) x = to_world * x;
    for (Vec3& v : body.velocity) v = turn * v;
  }
}

}  // namespace valsalva::deploy
