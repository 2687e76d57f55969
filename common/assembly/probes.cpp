#include "assembly/probes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::assembly {
namespace {

std::string unit_of(const std::string& quantity) {
  if (quantity == "displacement" || quantity == "position") return "mm";
  if (quantity == "velocity") return "mm_per_s";
  if (quantity == "rotation") return "rad";
  static const std::map<std::string, std::string> others{
      {"reaction", "N"},           {"contact_force", "N"},
      {"reaction_moment", "N_mm"}, {"contact_area", "mm2"},
      {"penetration", "mm"},       {"kinetic_energy", "nJ"},
      {"stored_energy", "nJ"},     {"total_energy", "nJ"},
      {"momentum", "g_mm_per_s"},  {"angular_momentum", "g_mm2_per_s"},
      {"stretch", "ratio"},        {"von_mises", "kPa"},
      {"stress", "kPa"},           {"volume", "mm3"},
      {"pressure", "kPa"}};
  return others.at(quantity);
}

double component_of(const Vec3& v, const std::string& component, const Vec3& direction) {
  if (component == "x") return v.x();
  if (component == "y") return v.y();
  if (component == "z") return v.z();
  return component == "direction" ? v.dot(direction) : v.norm();
}

Vec3 rotation_vector(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

}  // namespace

/// Forces of all terms at the present state, evaluated at most once.
struct Probes::Present {
  structure::Forces total;
  bool known = false;
};

namespace {

bool is_one_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void check_components(const std::string& quantity, const std::string& component, const std::string& what) {
  const bool of_stress = is_one_of(
      component, {"xx", "yy", "zz", "xy", "yz", "zx", "principal_max", "principal_min", "mean", "fibre"});
  if (of_stress != (quantity == "stress") && !(quantity == "stress" && component == "direction"))
    throw InputError("{}: component is \"{}\" for quantity = \"{}\"; expected {}", what, component, quantity,
                     of_stress ? "x, y, z, magnitude, direction or radial"
                               : "xx, yy, zz, xy, yz, zx, principal_max, principal_min, mean, fibre or "
                                 "direction");
  if (component == "radial" &&
      !is_one_of(quantity, {"displacement", "position", "velocity", "reaction", "contact_force"}))
    throw InputError(
        "{}: component is \"radial\" for quantity = \"{}\"; expected displacement, position, velocity, "
        "reaction "
        "or contact_force",
        what, quantity);
}

}  // namespace

void Probes::check(const Probe& p, const Scene& built, const std::string& what) {
  check_components(p.quantity, p.component, what);
  const auto named = [&](const auto& known, const char* kind) {
    if (!known.contains(p.of)) throw InputError("{}: of = '{}'; expected the name of {}", what, p.of, kind);
  };
  if (is_one_of(p.quantity, {"displacement", "position", "velocity", "rotation"})) {
    const auto& nodes = built.set(p.of, what);
    if (p.quantity == "rotation" && built.system->rotation_of(nodes.front()) < 0)
      throw InputError("{}: of = '{}' are not beam nodes; expected a set of those", what, p.of);
  } else if (is_one_of(p.quantity, {"stretch", "von_mises", "stress"})) {
    const BuiltBody& body = built.body(p.of, what);
    const bool none = body.kind == Kind::rigid || (body.kind == Kind::beams && p.quantity != "stretch") ||
                      (body.shell && p.quantity == "stress");
    if (none)
      throw InputError("{}: body '{}' has no {}; expected a {}", what, p.of, p.quantity,
                       p.quantity == "stress" ? "solid or Kirchhoff shell" : "shell or solid");
    if (p.layer != "largest" && !body.kirchhoff)
      throw InputError("{}: layer = \"{}\", but body '{}' is no Kirchhoff shell", what, p.layer, p.of);
    if (p.layer == "bending" && p.quantity != "stress")
      throw InputError("{}: layer = \"bending\" for quantity = \"{}\"; expected stress", what, p.quantity);
    if (p.component == "fibre" && !(body.kirchhoff && !body.kirchhoff->mesh().fibre1.empty()))
      throw InputError("{}: component = \"fibre\", but body '{}' is no Kirchhoff shell with fibres", what,
                       p.of);
  } else if (is_one_of(p.quantity, {"reaction", "reaction_moment"})) {
    if (std::none_of(built.supports.begin(), built.supports.end(), [&](auto& s) { return s.name == p.of; }))
      throw InputError("{}: of = '{}'; expected the name of a [[support]]", what, p.of);
  } else if (p.quantity == "contact_force" || p.quantity == "penetration") {
    named(built.first_body, "a [[contact_pair]]");
  } else if (p.quantity == "contact_area") {
    named(built.surfaces, "a [[contact_pair]] with a rigid surface");
  } else if (p.quantity == "pressure") {
    named(built.volumes, "a [[load]] of kind = \"volume\"");
  } else if (p.quantity == "volume") {
    if (!built.volumes.contains(p.of) && built.body(p.of, what).surface().empty())
      throw InputError("{}: body '{}' has no surface", what, p.of);
  } else if (is_one_of(p.quantity, {"momentum", "angular_momentum"})) {
    if (!p.of.empty()) built.body(p.of, what);
  } else if (p.quantity == "stored_energy" && !p.of.empty()) {
    named(built.named, "a body, tie, tether or contact pair, or none for all");
  }
}

Probes::Probes(const Case& scene, const Scene& built) {
  for (const BuiltBody& body : built.bodies)
    reference_.insert(reference_.end(), body.mesh.points.begin(), body.mesh.points.end());
  for (const Case& entry : scene.entries("probe")) {
    const auto text = [&](const char* key) { return entry.text(std::string("probe.") + key); };
    const auto& d = entry.reals("probe.direction");
    Probe p{text("name"),      text("quantity"), text("of"),         text("component"),
            text("statistic"), text("layer"),    {d[0], d[1], d[2]}, std::nullopt};
    const std::string what = fmt::format("{}: [[probe]] '{}'", scene.file().string(), p.name);
    if (p.name.empty()) throw InputError("{}: name is missing; expected one", what);
    if (!(p.direction.norm() > 0)) throw InputError("{}: direction is zero; expected a direction", what);
    p.direction.normalize();
    if (const auto& at = entry.reals("probe.point_mm"); !at.empty()) {
      if (at.size() != 3) throw InputError("{}: point_mm has {} entries; expected 3", what, at.size());
      p.point = Vec3(at[0], at[1], at[2]);
    }
    check(p, built, what);
    columns_.push_back(p.name + "_" + unit_of(p.quantity));
    if (std::count(columns_.begin(), columns_.end(), columns_.back()) > 1)
      throw InputError("{}: two probes give the column '{}'; give each its own name", what, columns_.back());
    probes_.push_back(std::move(p));
  }
}

Vec3 Probes::from_axis(const Vec3& x, const Probe& p) {
  const Vec3 d = x - p.point.value_or(Vec3::Zero());
  return d - p.direction.dot(d) * p.direction;
}

Vec3 Probes::outward(const Vec3& x, const Probe& p) {
  const Vec3 d = from_axis(x, p);
  return d.norm() > 0 ? d.normalized() : Vec3(Vec3::Zero());
}

double Probes::of_nodes(const Probe& p, const Scene& scene) const {
  const structure::Configuration& now = scene.system->state;
  const auto radius = [&](const Vec3& x) { return from_axis(x, p).norm(); };
  Points vectors;
  std::vector<double> all;
  for (int a : scene.nodes.at(p.of)) {
    const Vec3 &x = now.x[a], &start = reference_[a];
    if (p.quantity == "rotation")
      vectors.push_back(rotation_vector(now.rotation[scene.system->rotation_of(a)]));
    if (p.quantity == "velocity") vectors.push_back(now.v[a]);
    if (p.quantity == "position") vectors.push_back(x);
    if (p.quantity == "displacement") vectors.push_back(x - start);
    if (p.component != "radial")
      all.push_back(component_of(vectors.back(), p.component, p.direction));
    else if (p.quantity == "velocity")
      all.push_back(outward(x, p).dot(now.v[a]));
    else
      all.push_back(radius(x) - (p.quantity == "displacement" ? radius(start) : 0));
  }
  if (p.statistic == "min") return *std::min_element(all.begin(), all.end());
  if (p.statistic == "max") return *std::max_element(all.begin(), all.end());
  if (p.component == "radial") return std::reduce(all.begin(), all.end()) / static_cast<double>(all.size());
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : vectors) sum += v;
  return component_of(sum / static_cast<double>(vectors.size()), p.component, p.direction);
}

double Probes::of_support(const Probe& p, const Scene& scene, Present& present) const {
  const structure::Configuration& now = scene.system->state;
  const structure::System& system = *scene.system;
  const Support& s = *std::find_if(scene.supports.begin(), scene.supports.end(),
                                   [&](const Support& one) { return one.name == p.of; });
  const Vec3 about = p.point.value_or(Vec3::Zero());
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double radial = 0;
  const auto add = [&](const Vec3& at, const Vec3& f, const Vec3& m) {
    force += f;
    radial += outward(at, p).dot(f);
    moment += m + (at - about).cross(f);
  };
  if (s.tether_uN_per_mm > 0) {
    structure::Forces own;
    own.reset(system.nodes(), system.rotational_nodes());
    scene.named.at(s.name)->add_forces(now, own);
    for (int a : s.nodes) add(now.x[a], own.force[a], Vec3::Zero());
  } else {
    if (!present.known) {
      present.total.reset(system.nodes(), system.rotational_nodes());
      for (const auto& term : scene.terms) term->add_forces(now, present.total);
      present.known = true;
    }
    const auto part = [&](const Vec3& f, const std::array<bool, 3>& held) -> Vec3 {
      if (s.symmetry) return s.normal * s.normal.dot(f);
      return Vec3(held[0] ? f[0] : 0, held[1] ? f[1] : 0, held[2] ? f[2] : 0);
    };
    if (const auto& rigid = scene.body_of(s.nodes.front()).rigid) {
      const Vec3 f = rigid->force(present.total) + rigid->weight(now.time_s);
      add(rigid->centre(), -rigid->held() * f, -rigid->held_spin() * rigid->torque(system, present.total));
    } else {
      for (int a : s.nodes) {
        const int r = system.rotation_of(a);
        Vec3 m = Vec3::Zero();
        if (r >= 0) {
          m = -present.total.moment[r];
          m = s.symmetry ? Vec3(m - s.normal * s.normal.dot(m)) : part(m, s.rotation);
        }
        add(now.x[a], part(-present.total.force[a], s.translation), m);
      }
    }
  }
  if (p.component == "radial") return radial / units::uN_per_N;
  return component_of(p.quantity == "reaction" ? force : moment, p.component, p.direction) / units::uN_per_N;
}

double Probes::of_motion(const Probe& p, const Scene& scene) const {
  const structure::System& system = *scene.system;
  const Vec3 about = p.point.value_or(Vec3::Zero());
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  for (const BuiltBody& body : scene.bodies) {
    if ((!p.of.empty() && body.name != p.of) || (body.kind == Kind::rigid && !body.rigid)) continue;
    if (body.rigid) {
      momentum += body.rigid->momentum();
      angular += body.rigid->angular_momentum() - about.cross(body.rigid->momentum());
      continue;
    }
    for (int a = body.at.begin(); a < body.at.end(); ++a) {
      const Vec3 own = system.mass(a) * system.state.v[a];
      momentum += own;
      angular += (system.state.x[a] - about).cross(own);
      if (const int r = system.rotation_of(a); r >= 0)
        angular += system.inertia(r) * system.state.angular_velocity[r];
    }
  }
  return component_of(p.quantity == "momentum" ? momentum : angular, p.component, p.direction);
}

double Probes::value(const Probe& p, const Scene& scene, Present& present, double kinetic_nJ) const {
  const structure::Configuration& now = scene.system->state;
  const auto forces_of = [&](const structure::ForceTerm& term, double& energy) {
    structure::Forces out;
    out.reset(scene.system->nodes(), scene.system->rotational_nodes());
    energy = term.add_forces(now, out);
    return out;
  };
  double energy = 0;
  if (p.quantity == "kinetic_energy") return kinetic_nJ;
  if (p.quantity == "stored_energy" || p.quantity == "total_energy") {
    if (!p.of.empty()) {
      forces_of(*scene.named.at(p.of), energy);
      return energy;
    }
    double total = p.quantity == "total_energy" ? kinetic_nJ : 0;
    for (const auto& term : scene.terms) {
      forces_of(*term, energy);
      total += energy;
    }
    return total;
  }
  if (is_one_of(p.quantity, {"stretch", "von_mises", "stress"})) return of_elements(p, scene);
  if (is_one_of(p.quantity, {"reaction", "reaction_moment"})) return of_support(p, scene, present);
  if (is_one_of(p.quantity, {"momentum", "angular_momentum"})) return of_motion(p, scene);
  if (p.quantity == "contact_force") {
    const structure::Body& body = scene.body(scene.first_body.at(p.of), p.name).at;
    const structure::Forces own = forces_of(*scene.named.at(p.of), energy);
    Vec3 sum = Vec3::Zero();
    double radial = 0;
    for (int a = body.begin(); a < body.end(); ++a) {
      sum += own.force[a];
      radial += outward(now.x[a], p).dot(own.force[a]);
    }
    return (p.component == "radial" ? radial : component_of(sum, p.component, p.direction)) / units::uN_per_N;
  }
  if (p.quantity == "contact_area") return scene.surfaces.at(p.of)->area_mm2(now);
  if (p.quantity == "penetration") return penetration(p, scene);
  if (p.quantity == "pressure") return scene.volumes.at(p.of)->pressure_Pa(now) / units::pa_per_kPa;
  if (p.quantity == "volume") {
    if (const auto load = scene.volumes.find(p.of); load != scene.volumes.end())
      return load->second->volume_mm3(now.x);
    const BuiltBody& body = scene.body(p.of, p.name);
    double six = 0;
    for (const Triangle& t : body.surface())
      six +=
          now.x[body.at.offset + t[0]].dot(now.x[body.at.offset + t[1]].cross(now.x[body.at.offset + t[2]]));
    return six / 6;
  }
  return of_nodes(p, scene);
}

double Probes::penetration(const Probe& p, const Scene& scene) const {
  if (const auto surface = scene.surfaces.find(p.of); surface != scene.surfaces.end())
    return surface->second->penetration_mm(scene.system->state);
  const auto contact = std::dynamic_pointer_cast<contact::BodyContact>(scene.named.at(p.of));
  double most = 0;
  for (const auto& one : contact->candidates().mesh().bodies())
    for (const auto& other : contact->candidates().mesh().bodies())
      most = std::max(most, contact->penetration_mm(scene.system->state.x, one.name, other.name));
  return most;
}

std::vector<double> Probes::values(const Scene& scene, double kinetic_nJ) const {
  Present present;
  std::vector<double> row;
  for (const Probe& p : probes_) row.push_back(value(p, scene, present, kinetic_nJ));
  return row;
}

}  // namespace valsalva::assembly
