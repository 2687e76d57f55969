#include "assembly/probes.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>

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

constexpr double kPa = 1 / units::pa_per_kPa;

// The two principal stresses of the surface: without the normal's, which is zero.
std::pair<double, double> principal(const structure::LayerState& s) {
  const Vec3 all = Eigen::SelfAdjointEigenSolver<Mat3>(s.cauchy_Pa, Eigen::EigenvaluesOnly).eigenvalues();
  const double sum = all.sum(), squares = all.squaredNorm();
  const double half = std::sqrt(std::max(0.0, 0.5 * squares - 0.25 * sum * sum));
  return {0.5 * sum + half, 0.5 * sum - half};
}

double along(const Mat3& stress, const Vec3& direction) {
  return direction.dot(stress * direction);
}

void add_layers(const structure::KirchhoffShell& shell, const std::vector<structure::LayerStates>& states,
                std::map<std::string, CellField>& out) {
  const auto add = [&](const char* layer, const structure::LayerState& s, const Vec3* fibre) {
    const auto field = [&](const char* name) -> CellField& {
      return out[fmt::format("{}_{}_kPa", name, layer)];
    };
    const auto [most, least] = principal(s);
    field("principal_max").values.push_back(kPa * most);
    field("principal_min").values.push_back(kPa * least);
    field("von_mises").values.push_back(kPa * s.von_mises_Pa);
    if (fibre) field("fibre_stress").values.push_back(kPa * along(s.cauchy_Pa, *fibre));
    CellField& tensor = field("stress");
    tensor.components = 6;
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}})
      tensor.values.push_back(kPa * s.cauchy_Pa(i, j));
  };
  const auto& fibres = shell.mesh().fibre1;
  for (std::size_t e = 0; e < states.size(); ++e) {
    const structure::LayerStates& s = states[e];
    Vec3 fibre = Vec3::Zero();
    if (!fibres.empty()) fibre = (s.gradient * fibres[e]).normalized();
    const Vec3* given = fibres.empty() ? nullptr : &fibre;
    add("bottom", s.bottom, given);
    add("middle", s.middle, given);
    add("top", s.top, given);
  }
}

}  // namespace

ElementField element_field(const BuiltBody& body, const structure::Configuration& now) {
  ElementField field;
  if (body.shell)
    for (int e = 0; e < body.shell->elements(); ++e) {
      const auto s = body.shell->element_state(now.x, e, body.at.offset);
      field.stretch.push_back(s.stretch_major);
      field.von_mises_Pa.push_back(s.von_mises_Pa);
      field.exponent = std::max(field.exponent, s.exponent);
    }
  if (body.kirchhoff) {
    const auto states = body.kirchhoff->layer_states(now.x, body.at.offset);
    add_layers(*body.kirchhoff, states, field.layers);
    for (const structure::LayerStates& s : states) {
      field.stretch.push_back(
          std::max({s.bottom.stretch_major, s.middle.stretch_major, s.top.stretch_major}));
      field.von_mises_Pa.push_back(
          std::max({s.bottom.von_mises_Pa, s.middle.von_mises_Pa, s.top.von_mises_Pa}));
      field.exponent = std::max({field.exponent, s.bottom.exponent, s.middle.exponent, s.top.exponent});
    }
  }
  if (body.beams)
    for (int e = 0; e < body.beams->elements(); ++e)
      field.stretch.push_back(
          1 + body.beams->element_state(now.x, now.rotation, e, body.at.offset, body.at.rotation_offset)
                  .max_strain);
  if (body.solid)
    for (const auto& points : body.solid->all_points(now.x, body.at.offset)) {
      double stretch = 0, stress = 0;
      for (const auto& p : points) {
        stretch = std::max(stretch, p.stretch[2]);
        stress = std::max(stress, p.von_mises_Pa);
        field.exponent = std::max(field.exponent, p.exponent);
      }
      field.stretch.push_back(stretch);
      field.von_mises_Pa.push_back(stress);
    }
  return field;
}

namespace {

bool is_one_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void check_components(const std::string& quantity, const std::string& component, const std::string& what) {
  const bool of_stress = is_one_of(
      component, {"xx", "yy", "zz", "xy", "yz", "zx", "principal_max", "principal_min", "mean", "fibre"});
  if (of_stress != (quantity == "stress") && !(quantity == "stress" && component == "direction"))
    throw InputError("{}: component is \"{}\" for quantity = \"{}\"; expected {}", what, component, quantity,
                     of_stress ? "x, y, z, magnitude or direction"
                               : "xx, yy, zz, xy, yz, zx, principal_max, principal_min, mean, fibre or "
                                 "direction");
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

double Probes::of_vectors(const Probe& p, const Points& vectors) const {
  if (p.statistic == "mean") {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& v : vectors) sum += v;
    return component_of(sum / static_cast<double>(vectors.size()), p.component, p.direction);
  }
  std::vector<double> all;
  for (const Vec3& v : vectors) all.push_back(component_of(v, p.component, p.direction));
  return p.statistic == "min" ? *std::min_element(all.begin(), all.end())
                              : *std::max_element(all.begin(), all.end());
}

double Probes::of_elements(const Probe& p, const Scene& scene) const {
  const BuiltBody& body = scene.body(p.of, p.name);
  const structure::Configuration& now = scene.system->state;
  if (body.solid && (p.point || p.quantity == "stress")) return of_solid(p, body, now);
  if (body.kirchhoff) return of_layers(p, body, now);
  const ElementField field = element_field(body, now);
  const bool stretch = p.quantity == "stretch";
  const std::vector<double>& values = stretch ? field.stretch : field.von_mises_Pa;
  const double factor = stretch ? 1 : 1 / units::pa_per_kPa;
  if (!p.point) return factor * *std::max_element(values.begin(), values.end());
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < values.size(); ++e) {
    Vec3 middle = Vec3::Zero();
    const auto add = [&](const auto& nodes) {
      for (int a : nodes) middle += reference_[body.at.offset + a] / static_cast<double>(nodes.size());
    };
    body.beams ? add(body.mesh.lines[e]) : add(body.mesh.triangles[e]);
    if ((middle - *p.point).norm() < least) least = (middle - *p.point).norm(), nearest = e;
  }
  return factor * values[nearest];
}

double Probes::of_layers(const Probe& p, const BuiltBody& body, const structure::Configuration& now) const {
  const structure::KirchhoffShell& shell = *body.kirchhoff;
  const auto& fibres = shell.mesh().fibre1;
  const auto measure = [&](const structure::LayerState& s, const Mat3& gradient, std::size_t e) -> double {
    if (p.quantity == "stretch") return s.stretch_major;
    if (p.quantity == "von_mises") return kPa * s.von_mises_Pa;
    if (p.component == "principal_max") return kPa * principal(s).first;
    if (p.component == "principal_min") return kPa * principal(s).second;
    if (p.component == "mean") return kPa * s.cauchy_Pa.trace() / 3;
    if (p.component == "fibre") return kPa * along(s.cauchy_Pa, (gradient * fibres[e]).normalized());
    if (p.component == "direction") {
      const Vec3 carried = gradient * p.direction;
      return carried.norm() > 0 ? kPa * along(s.cauchy_Pa, carried.normalized()) : 0;
    }
    return kPa * s.cauchy_Pa(p.component[0] - 'x', p.component[1] - 'x');
  };
  const auto of_layer = [&](const structure::LayerStates& s, std::size_t e) -> double {
    if (p.layer == "bottom") return measure(s.bottom, s.gradient, e);
    if (p.layer == "middle") return measure(s.middle, s.gradient, e);
    if (p.layer == "top") return measure(s.top, s.gradient, e);
    if (p.layer == "bending") {
      structure::LayerState bent;
      bent.cauchy_Pa = 0.5 * (s.top.cauchy_Pa - s.bottom.cauchy_Pa);
      return measure(bent, s.gradient, e);
    }
    return std::max(
        {measure(s.bottom, s.gradient, e), measure(s.middle, s.gradient, e), measure(s.top, s.gradient, e)});
  };
  double least = std::numeric_limits<double>::infinity(), found = -least;
  const auto states = shell.layer_states(now.x, body.at.offset);
  for (std::size_t e = 0; e < states.size(); ++e) {
    const double value = of_layer(states[e], e);
    if (!p.point) {
      found = std::max(found, value);
      continue;
    }
    Vec3 middle = Vec3::Zero();
    for (int a : body.mesh.triangles[e]) middle += reference_[body.at.offset + a] / 3;
    if (const double d = (middle - *p.point).norm(); d < least) least = d, found = value;
  }
  return found;
}

double Probes::of_solid(const Probe& p, const BuiltBody& body, const structure::Configuration& now) const {
  const auto measure = [&](const structure::SolidPoint& at) -> double {
    if (p.quantity == "stretch") return at.stretch[2];
    if (p.quantity == "von_mises") return kPa * at.von_mises_Pa;
    if (p.component == "principal_max") return kPa * at.principal_Pa[2];
    if (p.component == "principal_min") return kPa * at.principal_Pa[0];
    if (p.component == "mean") return kPa * at.cauchy_Pa.trace() / 3;
    if (p.component == "direction") return kPa * along(at.cauchy_Pa, p.direction);
    return kPa * at.cauchy_Pa(p.component[0] - 'x', p.component[1] - 'x');
  };
  double least = std::numeric_limits<double>::infinity(), found = -least;
  for (const auto& points : body.solid->all_points(now.x, body.at.offset))
    for (const structure::SolidPoint& at : points) {
      if (!p.point) {
        found = std::max(found, measure(at));
      } else if (const double d = (at.reference - *p.point).norm(); d < least) {
        least = d;
        found = measure(at);
      }
    }
  return found;
}

double Probes::of_support(const Probe& p, const Scene& scene, Present& present) const {
  const structure::Configuration& now = scene.system->state;
  const structure::System& system = *scene.system;
  const Support& s = *std::find_if(scene.supports.begin(), scene.supports.end(),
                                   [&](const Support& one) { return one.name == p.of; });
  const Vec3 about = p.point.value_or(Vec3::Zero());
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  const auto add = [&](const Vec3& at, const Vec3& f, const Vec3& m) {
    force += f;
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
    for (int a = body.begin(); a < body.end(); ++a) sum += own.force[a];
    return component_of(sum, p.component, p.direction) / units::uN_per_N;
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
  const std::vector<int>& nodes = scene.nodes.at(p.of);
  const Points& at = p.quantity == "velocity" ? now.v : now.x;
  Points vectors;
  for (int a : nodes) {
    if (p.quantity == "rotation")
      vectors.push_back(rotation_vector(now.rotation[scene.system->rotation_of(a)]));
    else
      vectors.push_back(at[a]);
    if (p.quantity == "displacement") vectors.back() -= reference_[a];
  }
  return of_vectors(p, vectors);
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
