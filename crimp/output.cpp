#include "output.hpp"

#include <algorithm>

#include "bodies/frame.hpp"
#include "bodies/frame_law.hpp"
#include "core/errors.hpp"
#include "core/units.hpp"
#include "measures.hpp"

namespace valsalva::crimp {
namespace {

constexpr double uJ_per_nJ = 1e-3;
const std::string prefix = "integrator/";

Points slice(const Points& all, const structure::Body& body) {
  return Points(all.begin() + body.begin(), all.begin() + body.end());
}

}  // namespace

History make_history() {
  return History({"time_s", "crimper_diameter_mm", "radial_force_N", "kinetic_uJ", "internal_uJ",
                  "contact_uJ", "crimper_work_uJ", "damping_uJ", "mass_ratio", "contact_pairs",
                  "smallest_contact_ratio"});
}

void record(History& history, const Simulation& s) {
  const auto& e = s.integrator().energies();
  const std::size_t contact = 2 * s.device().tissue.size() + 1;  // after the elastic terms
  history.add({s.system().state.time_s, 2 * s.crimper_radius_mm(), s.radial_force_uN() / units::uN_per_N,
               uJ_per_nJ * e.kinetic, uJ_per_nJ * e.stored, uJ_per_nJ * s.integrator().stored_of(contact),
               uJ_per_nJ * s.crimper_work_nJ(), uJ_per_nJ * e.damping_work, s.integrator().mass_ratio(),
               static_cast<double>(s.body_contact().report().active),
               s.body_contact().report().smallest_ratio});
}

double largest_energy_ratio(const History& history) {
  const auto kinetic = history.column("kinetic_uJ"), internal = history.column("internal_uJ");
  if (internal.empty()) return 0;
  const double enough = 0.05 * *std::max_element(internal.begin(), internal.end());
  double most = 0;
  for (std::size_t i = 0; i < internal.size(); ++i)
    if (internal[i] > 0 && internal[i] >= enough) most = std::max(most, kinetic[i] / internal[i]);
  return most;
}

state::State snapshot(const StageContext& context, const state::State& stent, const Simulation& s,
                      const History& history) {
  using state::Array;
  const auto& now = s.system().state;
  state::State out = state::begin(context, now.time_s, s.integrator().steps());
  out.meshes = stent.meshes;
  out.restart = stent.restart;
  out.texts = stent.texts;
  for (const auto& body : s.system().bodies()) {
    state::Mesh& mesh = out.meshes.at(body.name);
    if (!body.rotational()) mesh.point_data["mounted"] = Array::of(mesh.points);
    mesh.points = slice(now.x, body);
    mesh.point_data["velocity"] = Array::of(slice(now.v, body));
    out.restart[body.name + "/velocity"] = Array::of(slice(now.v, body));
  }
  out.restart["frame/rotation"] = bodies::rotation_array(now.rotation);
  out.restart["frame/angular_velocity"] = Array::of(now.angular_velocity);
  bodies::write_fibres(s.struts().history(), out);
  out.restart["crimp/diameter_mm"] = Array::scalar(2 * s.crimper_radius_mm());
  out.restart["crimp/radius_mm"] = Array::scalar(s.crimper_radius_mm());
  for (const auto& [name, values] : s.save())
    if (!values.empty()) out.restart[prefix + name] = Array::of(values);
  if (history.rows() > 0) out.restart["crimp/history"] = Array::of(history.values());
  return out;
}

void restore(const state::State& from, Simulation& s, History& history) {
  structure::Snapshot values;
  for (const auto& [name, array] : from.restart)
    if (name.rfind(prefix, 0) == 0) values[name.substr(prefix.size())] = array.doubles(name);
  s.restore(values);
  if (from.has_array("crimp/history")) history.restore(from.array("crimp/history").doubles("crimp/history"));
}

void fill_summary(Summary& summary, const Simulation& s, const History& history, const Parameters& p) {
  const double diameter = outer_diameter_mm(s, p.thickness_fraction);
  const double energy_ratio = largest_energy_ratio(history);
  auto& m = summary.metrics;
  m["crimped_diameter_mm"] = diameter;
  m["crimped_diameter_Fr"] = diameter / units::mm_per_Fr;
  m["max_penetration_mm"] = penetration_mm(s);
  m["max_strut_penetration_mm"] = strut_penetration_mm(s);
  m["max_strut_strain_pct"] = 100 * max_strut_strain(s);
  m["kinetic_to_internal_energy_max"] = energy_ratio;
  m["radial_force_N"] = s.radial_force_uN() / units::uN_per_N;
  m["radial_force_max_N"] = [&] {
    const auto force = history.column("radial_force_N");
    return force.empty() ? 0.0 : *std::max_element(force.begin(), force.end());
  }();
  m["crimper_overlap_mm"] = s.crimper_overlap_mm();
  m["mass_ratio"] = s.integrator().mass_ratio();
  if (s.device().frame->superelastic()) {
    m["max_strut_martensite_pct"] = 100 * s.struts().largest_martensite();
    m["strut_dissipation_uJ"] = uJ_per_nJ * s.struts().dissipated_nJ();
  }
  m["slowed_node_steps"] = static_cast<double>(s.slowed());

  const auto at_most = [&](const std::string& name, double value, double limit) {
    summary.checks[name] = {value, limit, value <= limit};
  };
  at_most("kinetic_to_internal_energy_max", energy_ratio, 0.05);
  at_most("crimped_diameter_mm", diameter, p.target_diameter_mm + 0.05);
  at_most("crimper_overlap_mm", m["crimper_overlap_mm"], 0.05);
  at_most("settled_energy_ratio", s.integrator().energies().ratio(), p.settled_ratio);
  if (!s.device().tissue.empty()) {
    const TissueStretch leaflets = tissue_stretch(s, "leaflets"), skirt = tissue_stretch(s, "skirt");
    m["max_leaflet_stretch"] = leaflets.largest;
    m["max_skirt_stretch"] = skirt.largest;
    m["smallest_area_ratio"] = std::min(leaflets.smallest_area, skirt.smallest_area);
    m["edges_through_tissue"] = static_cast<double>(crossings(s));
    at_most("edges_through_tissue", m["edges_through_tissue"], 0);
    at_most("inverted_elements", static_cast<double>(leaflets.inverted + skirt.inverted), 0);
    const AreaBudget a = area_budget(s, p.thickness_fraction);
    summary.notes["area_budget"] = fmt::format(
        "fullest section at z = {:.1f} mm: crimper {:.1f} mm2, struts {:.1f}, tissue {:.1f} at its full "
        "thickness, "
        "{:.1f} at the compressed thickness in contact",
        a.z_mm, a.inside_mm2, a.struts_mm2, a.tissue_full_mm2, a.tissue_compressed_mm2);
    summary.extra["area_budget"] = {{"z_mm", a.z_mm},
                                    {"crimper_mm2", a.inside_mm2},
                                    {"struts_mm2", a.struts_mm2},
                                    {"tissue_full_mm2", a.tissue_full_mm2},
                                    {"tissue_compressed_mm2", a.tissue_compressed_mm2}};
    summary.notes["tissue_thickness"] = fmt::format(
        "in contact, tissue counts with {:.2f} of its thickness (squeezed and dehydrated when crimped; "
        "assumed)",
        p.thickness_fraction);
  }
  // No mid-surface or strut axis comes nearer to another than 0 without a crossing; 90 % of the contact
  // distance is where the layers would be squeezed to a tenth.
  const double squeezed = 1 - s.body_contact().report().smallest_ratio;
  m["largest_contact_squeeze"] = squeezed;
  at_most("largest_contact_squeeze", squeezed, 0.9);
  summary.notes["max_penetration_mm"] =
      "how far middles come nearer than the sum of their contact radii (compressed layers)";
  summary.notes["mass_scaling"] =
      fmt::format("explicit dynamics with masses scaled to the step: total mass {:.0f} times the real one",
                  s.integrator().mass_ratio());
  summary.extra["force_diameter"] = {{"diameter_mm", history.column("crimper_diameter_mm")},
                                     {"radial_force_N", history.column("radial_force_N")}};
}

}  // namespace valsalva::crimp
