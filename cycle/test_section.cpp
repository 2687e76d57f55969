#include "test_section.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "assembly/generate.hpp"
#include "assembly/material.hpp"
#include "assembly/scene.hpp"
#include "bodies/level_set.hpp"
#include "bodies/shell.hpp"
#include "core/errors.hpp"
#include "materials/holzapfel.hpp"
#include "materials/lee_sacks.hpp"

namespace valsalva::cycle {

namespace {

using assembly::BuiltBody;
using assembly::Kind;

constexpr double rad_per_deg = std::numbers::pi / 180;

class Vessel {
 public:
  explicit Vessel(const Case& scene)
      : z_(scene.reals("test_section.z_mm")),
        radius_(scene.reals("test_section.radius_mm")),
        depth_(scene.real("test_section.sinus_depth_mm")),
        turn_(scene.real("test_section.sinus_angle_deg") * rad_per_deg) {
    const std::string file = scene.file().string();
    if (z_.size() < 2 || z_.size() != radius_.size())
      throw InputError("{}: test_section.z_mm has {} values and radius_mm {}; expected as many, at least two",
                       file, z_.size(), radius_.size());
    if (!std::is_sorted(z_.begin(), z_.end(), std::less_equal<>()))
      throw InputError("{}: test_section.z_mm must be strictly ascending", file);
    const auto& sinus = scene.reals("test_section.sinus_z_mm");
    sinus_low_ = sinus[0];
    sinus_high_ = sinus[1];
    if (depth_ > 0 && !(sinus_low_ < sinus_high_))
      throw InputError("{}: test_section.sinus_z_mm is {} to {}; expected an ascending range", file,
                       sinus_low_, sinus_high_);
  }

  double low() const { return z_.front(); }
  double high() const { return z_.back(); }
  double largest_radius() const { return *std::max_element(radius_.begin(), radius_.end()) + depth_; }

  double radius(double theta, double z) const {
    const auto after = std::upper_bound(z_.begin() + 1, z_.end() - 1, z);
    const auto i = after - z_.begin();
    const double share = std::clamp((z - z_[i - 1]) / (z_[i] - z_[i - 1]), 0.0, 1.0);
    const double straight = radius_[i - 1] + share * (radius_[i] - radius_[i - 1]);
    if (!(depth_ > 0) || z <= sinus_low_ || z >= sinus_high_) return straight;
    const double rise = std::sin(std::numbers::pi * (z - sinus_low_) / (sinus_high_ - sinus_low_));
    return straight + depth_ * rise * rise * 0.5 * (1 + std::cos(3 * (theta - turn_)));
  }

  double distance(const Vec3& x) const {
    constexpr double step = 0.05;
    const double theta = std::atan2(x.y(), x.x()), z = std::clamp(x.z(), low(), high());
    const double slope = (radius(theta, z + step) - radius(theta, z - step)) / (2 * step);
    return (std::hypot(x.x(), x.y()) - radius(theta, z)) / std::sqrt(1 + slope * slope);
  }

  /// The wall as triangles, normals outwards.
  assembly::BodyMesh surface(double edge_mm) const {
    const auto map = [this](const Vec3& s) {
      const double theta = 2 * std::numbers::pi * s.x(), z = low() + s.y() * (high() - low());
      const double r = radius(theta, z);
      return Vec3(r * std::cos(theta), r * std::sin(theta), z);
    };
    const auto count = [&](double length) { return std::max(6, static_cast<int>(length / edge_mm)); };
    return assembly::sheet(map, {count(2 * std::numbers::pi * largest_radius()), count(high() - low())},
                           assembly::Pattern::alternating);
  }

 private:
  std::vector<double> z_, radius_;
  double depth_, turn_, sinus_low_ = 0, sinus_high_ = 0;
};

const Case& moving_entry(const Case& scene) {
  const Case* found = nullptr;
  int count = 0;
  for (const Case& entry : scene.entries("body")) {
    if (entry.text("body.kind") != "shell") continue;
    found = &entry;
    ++count;
  }
  if (count != 1)
    throw InputError("{}: {} [[body]] entries are shells; expected one, the leaflets: all others are rigid",
                     scene.file().string(), count);
  return *found;
}

std::string name_of(const Case& scene, const Case& entry) {
  return fmt::format("{}: [[body]] '{}'", scene.file().string(), entry.text("body.name"));
}

materials::HgoParameters hgo_of(const materials::MaterialSet& material, const std::string& what) {
  const auto at = [&](const char* key) {
    const auto found = material.parameters.find(key);
    return found == material.parameters.end() ? 0.0 : found->second;
  };
  if (material.law == "hgo") return {at("c10_Pa"), at("c01"), at("k1_Pa"), at("k2"), at("kappa")};
  if (material.law == "lee-sacks")
    return materials::as_hgo(materials::LeeSacksParameters{at("c0_Pa"), at("c1_Pa"), at("c2"), 1,
                                                           material.parameters.contains("w") ? at("w") : 1});
  if (material.law == "neo-hookean")
    return materials::as_hgo(materials::HolzapfelParameters{at("mu_Pa"), {0, 0}, {1, 1}});
  if (material.law == "holzapfel")
    return materials::as_hgo(
        materials::HolzapfelParameters{at("mu_Pa"), {at("a1_Pa"), at("a2_Pa")}, {at("b1"), at("b2")}});
  throw InputError(
      "{}: the law is '{}'; expected hgo, neo-hookean, holzapfel with equal families or lee-sacks (w = 1)",
      what, material.law);
}

/// Number of the connected piece of each triangle, in the order of the first nodes.
std::vector<std::int64_t> pieces_of(const std::vector<Triangle>& triangles, std::size_t nodes) {
  std::vector<int> root(nodes);
  for (std::size_t a = 0; a < nodes; ++a) root[a] = static_cast<int>(a);
  const auto find = [&](int a) {
    while (root[a] != a) a = root[a] = root[root[a]];
    return a;
  };
  for (const Triangle& t : triangles)
    for (int k = 1; k < 3; ++k) {
      const int a = find(t[0]), b = find(t[k]);
      root[std::max(a, b)] = std::min(a, b);
    }
  std::vector<int> number(nodes, -1);
  int count = 0;
  std::vector<std::int64_t> piece;
  for (const Triangle& t : triangles) {
    int& n = number[find(t[0])];
    if (n < 0) n = count++;
    piece.push_back(n);
  }
  return piece;
}

Leaflets leaflets_of(const assembly::Scene& built, const BuiltBody& body, bool one_family,
                     const std::string& what) {
  Leaflets l;
  l.name = "leaflets";
  l.points = l.rest = body.mesh.points;
  l.mesh = body.shell->mesh();
  if (one_family) l.mesh.fibre2.clear();
  for (const assembly::Support& support : built.supports)
    if (!support.holds_nodes() || support.motion.moves())
      throw InputError("{}: support '{}' moves or is elastic; expected a rigid hold at rest", what,
                       support.name);
  for (int a = body.at.begin(); a < body.at.end(); ++a) {
    const double held = built.system->held_directions(a).trace();
    if (held > 0.5 && held < 2.5)
      throw InputError("{}: node {} is held in some directions only; expected hold = [\"all\"]", what,
                       a - body.at.begin());
    l.attached.push_back(held > 2.5 ? 1 : 0);
  }
  const std::vector<std::int64_t> piece = pieces_of(l.mesh.triangles, l.points.size());
  if (*std::max_element(piece.begin(), piece.end()) != 2)
    throw InputError("{}: it has {} pieces; expected three leaflets that do not touch", what,
                     *std::max_element(piece.begin(), piece.end()) + 1);
  complete(l, piece, what);
  return l;
}

void refuse_what_has_no_meaning(const Case& scene) {
  for (const char* table : {"load", "tie", "contact_pair", "probe", "boundary", "obstacle", "flow_probe"})
    if (!scene.entries(table).empty())
      throw InputError("{}: [[{}]] beside [test_section]; expected only [[body]], [[nodes]] and [[support]]",
                       scene.file().string(), table);
}

}  // namespace

bool has_test_section(const Case& scene) {
  return scene.has("test_section");
}

Tissue tissue_in_test_section(const Case& scene) {
  const Case& entry = moving_entry(scene);
  const std::string what = name_of(scene, entry);
  Tissue t;
  t.law = hgo_of(assembly::material_of(entry, what), what);
  t.bending_modulus_Pa = entry.real("body.bending_scale") * materials::Hgo(t.law).matrix_modulus_Pa();
  const double membrane = entry.real("body.membrane_scale");
  t.law.c10_Pa *= membrane;
  t.law.k1_Pa *= membrane;
  return t;
}

Inputs test_section_inputs(const Case& scene, const Parameters& p) {
  refuse_what_has_no_meaning(scene);
  const Vessel vessel(scene);
  if (!(vessel.high() - vessel.low() > 10 * p.h))
    throw InputError("{}: test_section.z_mm spans {} mm; expected at least ten cells, {} mm",
                     scene.file().string(), vessel.high() - vessel.low(), 10 * p.h);
  const Case& entry = moving_entry(scene);
  const std::string what = name_of(scene, entry);
  if (entry.text("body.shell_element") != "hinge")
    throw InputError("{}: shell_element = \"{}\"; expected \"hinge\" for leaflets in a flow", what,
                     entry.text("body.shell_element"));
  const assembly::Scene built = assembly::compose(scene);

  Inputs in;
  in.low_z_mm = vessel.low();
  in.high_z_mm = vessel.high();
  const double sample = scene.real("test_section.sample_mm"), reach = vessel.largest_radius() + 4 * p.h;
  in.lumen = geometry::sample(Vec3(-reach, -reach, vessel.low() - 2), Vec3(reach, reach, vessel.high() + 2),
                              sample, [&](const Vec3& x) { return vessel.distance(x); });

  state::State& parent = in.parent;
  parent.source = scene.file().string();
  const assembly::BodyMesh wall = vessel.surface(1.5);
  parent.meshes["lumen"] = state::Mesh::of_triangles(wall.points, wall.triangles);
  for (const BuiltBody& body : built.bodies) {
    if (body.kind == Kind::shell) {
      const bool one_family = assembly::material_of(entry, what).fibre_angles_deg.size() < 2 &&
                              entry.reals("body.fibre_angles_deg").size() < 2;
      in.leaflets = leaflets_of(built, body, one_family, what);
      if (p.tissue.law.k1_Pa > 0 && in.leaflets->mesh.fibre1.empty())
        throw InputError("{}: its law has fibres; expected fibres = \"constant\" or \"cylindrical\"", what);
      structure::ShellMesh shell = in.leaflets->mesh;
      if (shell.fibre2.empty()) shell.fibre2 = shell.fibre1;
      const std::vector<std::int64_t> piece = pieces_of(shell.triangles, in.leaflets->points.size());
      parent.meshes["leaflets"] = bodies::shell_mesh(
          in.leaflets->points, shell, {in.leaflets->attached.begin(), in.leaflets->attached.end()}, piece);
      continue;
    }
    if (body.kind != Kind::rigid || body.free)
      throw InputError("{}: [[body]] '{}' is neither the leaflets nor rigid and fixed", scene.file().string(),
                       body.name);
    if (!in.mount) in.mount.emplace();
    const int offset = static_cast<int>(in.mount->points.size());
    in.mount->points.insert(in.mount->points.end(), body.mesh.points.begin(), body.mesh.points.end());
    for (const Triangle& t : body.mesh.triangles)
      in.mount->triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  if (in.mount) parent.meshes["mount"] = state::Mesh::of_triangles(in.mount->points, in.mount->triangles);
  return in;
}

}  // namespace valsalva::cycle
