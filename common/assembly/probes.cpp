#include "assembly/probes.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::assembly {
namespace {

std::string unit_of(const std::string& quantity) {
  if (quantity == "displacement" || quantity == "position") return "mm";
  if (quantity == "velocity") return "mm_per_s";
  if (quantity == "rotation") return "rad";
  if (quantity == "reaction" || quantity == "contact_force") return "N";
  if (quantity == "kinetic_energy" || quantity == "stored_energy") return "nJ";
  return quantity == "von_mises" ? "kPa" : "ratio";
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

ElementField element_field(const BuiltBody& body, const structure::Configuration& now) {
  ElementField field;
  if (body.shell)
    for (int e = 0; e < body.shell->elements(); ++e) {
      const auto s = body.shell->element_state(now.x, e, body.at.offset);
      field.stretch.push_back(s.stretch_major);
      field.von_mises_Pa.push_back(s.von_mises_Pa);
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
      }
      field.stretch.push_back(stretch);
      field.von_mises_Pa.push_back(stress);
    }
  return field;
}

Probes::Probes(const Case& scene, const Scene& built) : reference_(built.system->state.x) {
  for (const Case& entry : scene.entries("probe")) {
    const auto text = [&](const char* key) { return entry.text(std::string("probe.") + key); };
    const auto& d = entry.reals("probe.direction");
    Probe p{text("name"),      text("quantity"),  text("of"),
            text("component"), text("statistic"), {d[0], d[1], d[2]}};
    const std::string what = fmt::format("{}: [[probe]] '{}'", scene.file().string(), p.name);
    if (p.name.empty()) throw InputError("{}: name is missing; expected one", what);
    if (!(p.direction.norm() > 0)) throw InputError("{}: direction is zero; expected a direction", what);
    p.direction.normalize();
    const auto is = [&](std::initializer_list<const char*> names) {
      return std::find(names.begin(), names.end(), p.quantity) != names.end();
    };
    if (is({"displacement", "position", "velocity", "rotation"})) {
      const auto& nodes = built.set(p.of, what);
      if (p.quantity == "rotation" && built.system->rotation_of(nodes.front()) < 0)
        throw InputError("{}: of = '{}' are not beam nodes; expected a set of those", what, p.of);
    } else if (is({"stretch", "von_mises"})) {
      const Kind kind = built.body(p.of, what).kind;
      if (kind == Kind::rigid || (kind == Kind::beams && p.quantity == "von_mises"))
        throw InputError("{}: body '{}' has none; expected a shell or solid", what, p.of);
    } else if (p.quantity == "reaction") {
      if (std::none_of(built.supports.begin(), built.supports.end(), [&](auto& s) { return s.name == p.of; }))
        throw InputError("{}: of = '{}'; expected the name of a [[support]]", what, p.of);
    } else if (p.quantity == "contact_force" && !built.first_body.contains(p.of)) {
      throw InputError("{}: of = '{}'; expected the name of a [[contact_pair]]", what, p.of);
    } else if (p.quantity == "stored_energy" && !p.of.empty() && !built.named.contains(p.of)) {
      throw InputError("{}: of = '{}'; expected a body, tie, tether or contact pair, or none for all", what,
                       p.of);
    }
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

double Probes::value(const Probe& p, const Scene& scene, Present& present, double kinetic_nJ) const {
  const structure::Configuration& now = scene.system->state;
  const auto sum_of = [&](const Points& force, int begin, int end) {
    Vec3 sum = Vec3::Zero();
    for (int a = begin; a < end; ++a) sum += force[a];
    return component_of(sum, p.component, p.direction) / units::uN_per_N;
  };
  const auto forces_of = [&](const structure::ForceTerm& term, double& energy) {
    structure::Forces out;
    out.reset(scene.system->nodes(), scene.system->rotational_nodes());
    energy = term.add_forces(now, out);
    return out;
  };
  double energy = 0;
  if (p.quantity == "kinetic_energy") return kinetic_nJ;
  if (p.quantity == "stored_energy") {
    if (!p.of.empty()) {
      forces_of(*scene.named.at(p.of), energy);
      return energy;
    }
    double total = 0;
    for (const auto& term : scene.terms) {
      forces_of(*term, energy);
      total += energy;
    }
    return total;
  }
  if (p.quantity == "stretch" || p.quantity == "von_mises") {
    const ElementField field = element_field(scene.body(p.of, p.name), now);
    const auto& values = p.quantity == "stretch" ? field.stretch : field.von_mises_Pa;
    const double most = *std::max_element(values.begin(), values.end());
    return p.quantity == "stretch" ? most : most / units::pa_per_kPa;
  }
  if (p.quantity == "contact_force") {
    const structure::Body& body = scene.body(scene.first_body.at(p.of), p.name).at;
    return sum_of(forces_of(*scene.named.at(p.of), energy).force, body.begin(), body.end());
  }
  if (p.quantity == "reaction") {
    const Support& s = *std::find_if(scene.supports.begin(), scene.supports.end(),
                                     [&](const Support& one) { return one.name == p.of; });
    Points held;
    if (s.tether_uN_per_mm > 0) {
      const structure::Forces own = forces_of(*scene.named.at(s.name), energy);
      for (int a : s.nodes) held.push_back(own.force[a]);
    } else {
      if (!present.known) {
        present.total.reset(scene.system->nodes(), scene.system->rotational_nodes());
        for (const auto& term : scene.terms) term->add_forces(now, present.total);
        present.known = true;
      }
      for (int a : s.nodes) {
        Vec3 f = -present.total.force[a];
        if (s.symmetry)
          f = s.normal * s.normal.dot(f);
        else
          for (int d = 0; d < 3; ++d)
            if (!s.translation[d]) f[d] = 0;
        held.push_back(f);
      }
    }
    return sum_of(held, 0, static_cast<int>(held.size()));
  }
  Points vectors;
  for (int a : scene.nodes.at(p.of)) {
    if (p.quantity == "displacement") vectors.push_back(now.x[a] - reference_[a]);
    if (p.quantity == "position") vectors.push_back(now.x[a]);
    if (p.quantity == "velocity") vectors.push_back(now.v[a]);
    if (p.quantity == "rotation")
      vectors.push_back(rotation_vector(now.rotation[scene.system->rotation_of(a)]));
  }
  return of_vectors(p, vectors);
}

std::vector<double> Probes::values(const Scene& scene, double kinetic_nJ) const {
  Present present;
  std::vector<double> row;
  for (const Probe& p : probes_) row.push_back(value(p, scene, present, kinetic_nJ));
  return row;
}

}  // namespace valsalva::assembly
