#include "frame.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "core/errors.hpp"

namespace valsalva::stent {

namespace {

constexpr double pi = std::numbers::pi;

double radius(const Vec3& x) {
  return std::hypot(x.x(), x.y());
}

void check_design(const FrameDesign& d) {
  if (d.cells < 3) throw InputError("device.cells: {} cells around; expected at least 3", d.cells);
  if (d.level_mm.size() < 2)
    throw InputError("device.level_heights_mm: {} rows of crossings; expected at least 2", d.level_mm.size());
  if (d.level_mm.front() != 0)
    throw InputError("device.level_heights_mm: the first height is {} mm; expected 0, the inflow edge",
                     d.level_mm.front());
  for (std::size_t i = 1; i < d.level_mm.size(); ++i)
    if (!(d.level_mm[i] > d.level_mm[i - 1]) || !std::isfinite(d.level_mm[i]))
      throw InputError("device.level_heights_mm: height {} mm follows {} mm; expected ascending heights",
                       d.level_mm[i], d.level_mm[i - 1]);
  if (d.profile_mm.empty())
    throw InputError("device.profile_mm: no point; expected pairs of height and outer diameter");
  if (!(d.width_mm > 0) || !(d.depth_mm > 0))
    throw InputError("device.strut_width_mm = {}, device.strut_depth_mm = {}: expected positive sections",
                     d.width_mm, d.depth_mm);
  if (d.beams_per_strut < 1)
    throw InputError("device.beams_per_strut: {}; expected at least 1", d.beams_per_strut);
}

Profile node_profile(const FrameDesign& d) {
  std::vector<double> z, r;
  for (const auto& [height, diameter] : d.profile_mm) {
    z.push_back(height);
    r.push_back(diameter / 2 - d.depth_mm / 2);
  }
  return Profile(std::move(z), std::move(r), "device.profile_mm");
}

/// Adds the inner nodes and the beams of one strut; `point(t)` is its centreline, t from 0 to 1.
template <class Curve>
void cut_into_beams(Frame& frame, const Strut& strut, int beams, Curve&& point) {
  std::vector<int> chain{strut.from};
  for (int b = 1; b < beams; ++b) {
    chain.push_back(static_cast<int>(frame.nodes.size()));
    frame.nodes.push_back(point(static_cast<double>(b) / beams));
  }
  chain.push_back(strut.to);
  for (int b = 0; b < beams; ++b) {
    frame.beams.push_back({chain[b], chain[b + 1]});
    frame.width_mm.push_back(strut.width_mm);
    frame.depth_mm.push_back(strut.depth_mm);
  }
  frame.struts.push_back(strut);
  frame.strut_nodes.push_back(std::move(chain));
}

/// Crossings of one row have nearly the same height: their mean radius is a point of the profile.
Profile fitted_profile(Points crossings, const std::string& what) {
  std::sort(crossings.begin(), crossings.end(), [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
  constexpr double row_mm = 1.0;
  std::vector<double> heights, radii;
  for (std::size_t first = 0; first < crossings.size();) {
    std::size_t last = first;
    double z = 0, r = 0;
    for (; last < crossings.size() && crossings[last].z() - crossings[first].z() < row_mm; ++last)
      z += crossings[last].z(), r += radius(crossings[last]);
    const double count = static_cast<double>(last - first);
    heights.push_back(z / count), radii.push_back(r / count);
    first = last;
  }
  return Profile(std::move(heights), std::move(radii), what);
}

/// From a to b, straight in the unrolled plane; the ends' distances from the profile fade into each other. A
/// strut over more than a sixth of the circumference does not follow the surface: straight.
Vec3 on_surface(const Profile& profile, const Vec3& a, const Vec3& b, double t) {
  const double from = std::atan2(a.y(), a.x());
  const double turn = std::remainder(std::atan2(b.y(), b.x()) - from, 2 * pi);
  if (std::abs(turn) > pi / 3) return a + t * (b - a);
  const double z = std::lerp(a.z(), b.z(), t);
  const double r =
      profile.radius(z) + std::lerp(radius(a) - profile.radius(a.z()), radius(b) - profile.radius(b.z()), t);
  return {r * std::cos(from + t * turn), r * std::sin(from + t * turn), z};
}

}  // namespace

double closed_diameter_mm(int cells, double width_mm, double depth_mm) {
  return 2 * cells * width_mm / pi + depth_mm;
}

Frame build_frame(const FrameDesign& design) {
  check_design(design);
  const int n = design.cells, rows = static_cast<int>(design.level_mm.size());
  Frame frame;
  frame.profile = node_profile(design);
  for (double z : design.level_mm) {
    const double cell = 2 * pi * frame.profile.radius(z) / n;
    if (2 * design.width_mm >= cell)
      throw InputError(
          "device.strut_width_mm: two struts of {} mm do not fit a cell {:.3g} mm wide (height {} mm); make "
          "the "
          "struts narrower or the cells fewer",
          design.width_mm, cell, z);
  }
  frame.max_depth_mm = design.depth_mm;
  frame.crossings = rows * n;
  const auto at = [&](double half_pitches, double z) {
    const double angle = half_pitches * pi / n, r = frame.profile.radius(z);
    return Vec3(r * std::cos(angle), r * std::sin(angle), z);
  };
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < n; ++k) frame.nodes.push_back(at(2 * k + i % 2, design.level_mm[i]));
  for (int i = 0; i + 1 < rows; ++i)
    for (int k = 0; k < n; ++k)
      for (int side : {-1, 1}) {
        const int start = 2 * k + i % 2;
        const int end = start + side;  // in half pitches
        const int column = ((end - (i + 1) % 2) / 2 + n) % n;
        cut_into_beams(frame, {i * n + k, (i + 1) * n + column, design.width_mm, design.depth_mm},
                       design.beams_per_strut, [&](double t) {
                         return at(start + t * side,
                                   std::lerp(design.level_mm[i], design.level_mm[i + 1], t));
                       });
      }
  return frame;
}

Frame frame_from_struts(const Points& crossings, const std::vector<Strut>& struts, int beams_per_strut,
                        const std::string& label) {
  if (crossings.size() < 2 || struts.empty())
    throw InputError("{}: {} nodes and {} struts; expected at least 2 and 1", label, crossings.size(),
                     struts.size());
  for (std::size_t i = 0; i < crossings.size(); ++i)
    if (!crossings[i].allFinite())
      throw InputError("{}: node {} has a coordinate that is not finite; expected numbers in mm", label, i);

  const int n = static_cast<int>(crossings.size());
  std::vector<int> part(n), degree(n, 0);
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](int i) {
    while (part[i] != i) i = part[i] = part[part[i]];
    return i;
  };
  std::set<Edge> seen;
  for (std::size_t s = 0; s < struts.size(); ++s) {
    const Strut& strut = struts[s];
    for (int end : {strut.from, strut.to})
      if (end < 0 || end >= n)
        throw InputError("{}: strut {} ends at node {}, but nodes run from 0 to {}", label, s, end, n - 1);
    const double length = (crossings[strut.from] - crossings[strut.to]).norm();
    if (strut.from == strut.to || length <= 1e-6)
      throw InputError("{}: strut {} from node {} to node {} has no length; merge the two nodes", label, s,
                       strut.from, strut.to);
    if (!(strut.width_mm > 0) || !(strut.depth_mm > 0) || !std::isfinite(strut.width_mm + strut.depth_mm))
      throw InputError("{}: strut {} has the section {} x {} mm; expected positive width and depth", label, s,
                       strut.width_mm, strut.depth_mm);
    if (std::max(strut.width_mm, strut.depth_mm) > length)
      throw InputError(
          "{}: strut {} is {:.3g} mm long but its section is {} x {} mm; a beam must be longer than "
          "thick",
          label, s, length, strut.width_mm, strut.depth_mm);
    if (!seen.insert({std::min(strut.from, strut.to), std::max(strut.from, strut.to)}).second)
      throw InputError("{}: strut {} from node {} to node {} occurs twice", label, s, strut.from, strut.to);
    ++degree[strut.from], ++degree[strut.to];
    part[root(strut.from)] = root(strut.to);
  }
  for (int i = 0; i < n; ++i) {
    if (degree[i] == 0) throw InputError("{}: no strut reaches node {}; remove it or join it", label, i);
    if (root(i) != root(0))
      throw InputError("{}: node {} is not connected with node 0; a frame must be one piece", label, i);
  }

  Frame frame;
  frame.nodes = crossings;
  double low = crossings[0].z();
  for (const Vec3& x : crossings) low = std::min(low, x.z());
  for (Vec3& x : frame.nodes) x.z() -= low;
  frame.crossings = n;
  frame.profile = fitted_profile(frame.nodes, label + ": radii of the nodes about the z axis");
  for (const Strut& strut : struts) {
    frame.max_depth_mm = std::max(frame.max_depth_mm, strut.depth_mm);
    const Vec3 a = frame.nodes[strut.from], b = frame.nodes[strut.to];
    cut_into_beams(frame, strut, beams_per_strut,
                   [&](double t) { return on_surface(frame.profile, a, b, t); });
  }
  return frame;
}

FrameMeasures measure(const Frame& frame) {
  FrameMeasures m;
  double low = frame.nodes[0].z(), high = low, smallest = radius(frame.nodes[0]);
  for (const Vec3& x : frame.nodes) {
    low = std::min(low, x.z()), high = std::max(high, x.z());
    smallest = std::min(smallest, radius(x));
  }
  const auto mean_outer_diameter = [&](double z) {
    double sum = 0;
    int count = 0;
    for (int i = 0; i < frame.crossings; ++i)
      if (std::abs(frame.nodes[i].z() - z) < 0.5) sum += 2 * radius(frame.nodes[i]), ++count;
    return sum / count + frame.max_depth_mm;
  };
  m.inflow_diameter_mm = mean_outer_diameter(low);
  m.outflow_diameter_mm = mean_outer_diameter(high);
  m.waist_diameter_mm = 2 * smallest + frame.max_depth_mm;
  m.height_mm = high - low;
  return m;
}

std::vector<int> degrees(const Frame& frame) {
  std::vector<int> degree(frame.nodes.size(), 0);
  for (const auto& [a, b] : frame.beams) ++degree[a], ++degree[b];
  return degree;
}

}  // namespace valsalva::stent
