// Stress and strain of elements: the probes and the fields of the views.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "assembly/probes.hpp"
#include "core/units.hpp"

namespace valsalva::assembly {
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

}  // namespace valsalva::assembly
