#include "inputs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "bodies/level_set.hpp"
#include "bodies/shell.hpp"
#include "core/errors.hpp"

namespace valsalva::cycle {

namespace {

std::vector<double> real_values(const state::Array& array) {
  return std::visit([](const auto& data) { return std::vector<double>(data.begin(), data.end()); },
                    array.data);
}

// Edges that belong to one triangle only.
std::vector<Edge> boundary_edges(const std::vector<Triangle>& triangles) {
  std::map<Edge, int> count;
  for (const Triangle& t : triangles)
    for (int e = 0; e < 3; ++e) {
      const int a = t[e], b = t[(e + 1) % 3];
      ++count[{std::min(a, b), std::max(a, b)}];
    }
  std::vector<Edge> edges;
  for (const auto& [edge, times] : count)
    if (times == 1) edges.push_back(edge);
  return edges;
}

std::array<int, 3> tips_of(const Leaflets& l, const std::vector<Edge>& boundary) {
  std::set<int> free_nodes;
  for (const Edge& e : boundary)
    for (int a : e)
      if (!l.attached[a]) free_nodes.insert(a);
  std::array<int, 3> tip{-1, -1, -1};
  std::array<double, 3> furthest{};
  for (const int a : free_nodes) {
    double nearest = 1e300;
    for (std::size_t b = 0; b < l.attached.size(); ++b)
      if (l.attached[b] && l.leaflet[b] == l.leaflet[a])
        nearest = std::min(nearest, (l.mesh.reference[a] - l.mesh.reference[b]).norm());
    const int leaf = l.leaflet[a];
    if (leaf >= 0 && leaf < 3 && nearest > furthest[leaf]) {
      furthest[leaf] = nearest;
      tip[leaf] = a;
    }
  }
  return tip;
}

Leaflets read_leaflets(const state::State& file, const std::string& name, double factor) {
  const state::Mesh& mesh = file.mesh(name);
  Leaflets l;
  l.name = name;
  l.points = mesh.points;
  l.rest =
      mesh.point_data.count("mounted") ? mesh.point_data.at("mounted").points(name + "/mounted") : l.points;
  l.mesh = bodies::read_shell(file, name, factor);
  const std::vector<bool> attached = bodies::read_attached(file, name);
  l.attached.assign(attached.begin(), attached.end());
  complete(l, file.cell_data(name, "leaflet").integers(name + "/leaflet"), file.source);
  return l;
}

}  // namespace

void complete(Leaflets& l, const std::vector<std::int64_t>& of_cell, const std::string& source) {
  l.leaflet.assign(l.points.size(), -1);
  for (std::size_t t = 0; t < l.mesh.triangles.size(); ++t)
    for (int a : l.mesh.triangles[t]) l.leaflet[a] = static_cast<int>(of_cell[t]);
  if (std::count(l.attached.begin(), l.attached.end(), 1) == 0)
    throw InputError("{}: no node of '{}' is attached; the leaflets would be washed away", source, l.name);
  const std::vector<Edge> boundary = boundary_edges(l.mesh.triangles);
  for (const Edge& e : boundary)
    if (l.attached[e[0]] && l.attached[e[1]]) l.attachment.push_back(e);
  l.tip = tips_of(l, boundary);
  for (int leaf = 0; leaf < 3; ++leaf)
    if (l.tip[leaf] < 0)
      throw InputError("{}: leaflet {} of '{}' has no free edge; expected three leaflets numbered 0, 1, 2",
                       source, leaf, l.name);
  double length = 0;
  for (const Triangle& t : l.mesh.triangles)
    for (int e = 0; e < 3; ++e) length += (l.mesh.reference[t[e]] - l.mesh.reference[t[(e + 1) % 3]]).norm();
  l.mean_edge_mm = length / (3.0 * static_cast<double>(l.mesh.triangles.size()));
}

double Inputs::wall_distance(const Vec3& x) const {
  // The level set is closed by the cuts: read it a little inside them.
  const double inset = 2 * lumen.spacing;
  const double z = std::clamp(x.z(), low_z_mm + inset, high_z_mm - inset);
  return lumen.value(Vec3(x.x(), x.y(), z));
}

Inputs read_inputs(const std::filesystem::path& path, const Parameters& p) {
  Inputs in;
  in.parent = state::read_final(path, p.device ? "deploy" : "mesher");
  const state::State& file = in.parent;
  in.lumen = bodies::read_level_set(file, "lumen");
  const std::vector<double>& cuts = file.array("anatomy/z_mm").doubles("anatomy/z_mm");
  if (cuts.size() < 2 || !(cuts.back() - cuts.front() > 10 * p.h))
    throw InputError("{}: 'anatomy/z_mm' has no two cuts at least {} mm apart; run segment again",
                     file.source, 10 * p.h);
  in.low_z_mm = cuts.front();
  in.high_z_mm = cuts.back();
  const std::string moving = p.device ? "leaflets" : "native_leaflets";
  if (file.has_mesh(moving)) in.leaflets = read_leaflets(file, moving, p.tissue.stiffness_factor);
  if (!p.device) return in;

  const state::Mesh& frame = file.mesh("frame");
  in.frame = HeldFrame{frame.points, frame.lines("frame"), {}};
  for (const double depth : file.cell_data("frame", "depth_mm").doubles("frame/depth_mm"))
    in.frame->half_depth_mm.push_back(0.5 * depth);
  if (file.has_mesh("skirt"))
    in.skirt = HeldShell{file.mesh("skirt").points, file.mesh("skirt").triangles("skirt")};
  if (file.has_mesh("native_leaflets"))
    in.native = HeldShell{file.mesh("native_leaflets").points,
                          file.mesh("native_leaflets").triangles("native_leaflets")};
  for (const double capacity : real_values(file.array("deploy/friction_capacity_uN")))
    in.friction_capacity_uN += capacity;
  return in;
}

fluid::Grid box_of(const Inputs& in, double h, double margin_cells) {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  const double step = in.lumen.spacing;
  for (double z = in.low_z_mm; z <= in.high_z_mm; z += step)
    for (int j = 0; j < in.lumen.dimensions[1]; ++j)
      for (int i = 0; i < in.lumen.dimensions[0]; ++i) {
        const Vec3 x(in.lumen.origin.x() + i * step, in.lumen.origin.y() + j * step, z);
        if (!(in.wall_distance(x) < 0)) continue;
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
      }
  if (!(low.x() < high.x()))
    throw InputError("{}: the level set has no inside between z = {:.2f} and {:.2f} mm; run segment again",
                     in.parent.source, in.low_z_mm, in.high_z_mm);
  // A cell for the standoff, by which nodes may couple further outside.
  if (in.leaflets)
    for (const Vec3& x : in.leaflets->points) {
      low = low.cwiseMin(x - Vec3::Constant(h));
      high = high.cwiseMax(x + Vec3::Constant(h));
    }
  // Sizes with small factors only, for the transforms.
  const auto friendly = [](int n) {
    for (;; ++n) {
      int m = n;
      for (const int f : {2, 3, 5, 7})
        while (m % f == 0) m /= f;
      if (m == 1) return n;
    }
  };
  fluid::Grid grid;
  grid.h = h;
  const int margin = std::max(2, static_cast<int>(std::ceil(margin_cells)));
  for (int d = 0; d < 2; ++d) {
    grid.cells[d] = friendly(static_cast<int>(std::ceil((high[d] - low[d]) / h)) + 2 * margin);
    grid.origin[d] = 0.5 * (low[d] + high[d]) - 0.5 * h * grid.cells[d];
  }
  grid.cells[2] = static_cast<int>(std::lround((in.high_z_mm - in.low_z_mm) / h));
  grid.origin[2] = 0.5 * (in.low_z_mm + in.high_z_mm) - 0.5 * h * grid.cells[2];
  return grid;
}

std::vector<int> mark_solids(const Inputs& in, const Masks& masks, fluid::Solids& solids, double h) {
  std::vector<int> device;
  solids.set_lumen([&](const Vec3& x) { return in.wall_distance(x); });
  if (in.leaflets) {
    const int edge = solids.add_body("attached edge");
    solids.mark_segments(edge, in.leaflets->points, in.leaflets->attachment, masks.edge * h);
    if (in.frame) device.push_back(edge);
  }
  if (in.frame) {
    const int frame = solids.add_body("frame");
    for (std::size_t s = 0; s < in.frame->struts.size(); ++s)
      solids.mark_segments(frame, in.frame->points, {in.frame->struts[s]},
                           std::max(in.frame->half_depth_mm[s], masks.strut * h));
    device.push_back(frame);
  }
  if (in.skirt) {
    const int skirt = solids.add_body("skirt");
    solids.mark_triangles(skirt, in.skirt->points, in.skirt->triangles, masks.shell * h);
    device.push_back(skirt);
  }
  if (in.native) {
    const int native = solids.add_body("native leaflets");
    solids.mark_triangles(native, in.native->points, in.native->triangles, masks.shell * h);
  }
  if (in.mount) {
    const int mount = solids.add_body("mount");
    solids.mark_triangles(mount, in.mount->points, in.mount->triangles, masks.shell * h);
  }
  return device;
}

}  // namespace valsalva::cycle
