// One sixth of a closed valve under the diastolic pressure, as a solid: half a leaflet between its middle
// plane (y = 0) and the plane of coaptation at 60 degrees, ruled between the attachment on a cylinder, z = h
// s^2, and the free edge from the commissure to the axis. Both planes and the free edge are planes of
// symmetry, the attachment and the commissure are clamped, the pressure follows the aortic face. No contact:
// the plane of coaptation stands for the other leaflet. Neo-Hookean, W = mu/2 (I1~ - 3) + K/2 (J - 1)^2:
// CalculiX has it too.
#pragma once

#include <algorithm>
#include <cmath>

#include "materials/neo_hookean.hpp"
#include "solid_meshes.hpp"
#include "solve/statics.hpp"
#include "structure/solid_surface.hpp"

namespace valsalva::bench {

using namespace structure;

struct ClosedValve {
  double radius_mm = 12, height_mm = 9, post_mm = 3, centre_mm = 5, thickness_mm = 0.4;
  double shear_Pa = 4e5, bulk_Pa = 8e6, pressure_Pa = 12e3, density = 1.1e-3;
};

inline Vec3 leaflet_point(const ClosedValve& v, double s, double t) {
  const double angle = M_PI / 3;
  const Vec3 low(v.radius_mm * std::cos(angle * s), v.radius_mm * std::sin(angle * s), v.height_mm * s * s);
  const Vec3 post(v.radius_mm * std::cos(angle), v.radius_mm * std::sin(angle), v.height_mm + v.post_mm);
  return (1 - t) * low + t * (s * post + (1 - s) * Vec3(0, 0, v.centre_mm));
}

/// The surface s, t with the thickness along its normal, towards the aorta.
inline Vec3 valve_point(const ClosedValve& v, const Vec3& u) {
  const double h = 1e-5, s = std::clamp(u.x(), h, 1 - h), t = std::clamp(u.y(), h, 1 - h);
  const Vec3 along = leaflet_point(v, s + h, t) - leaflet_point(v, s - h, t);
  const Vec3 inwards = leaflet_point(v, s, t + h) - leaflet_point(v, s, t - h);
  return leaflet_point(v, u.x(), u.y()) + (u.z() - 0.5) * v.thickness_mm * along.cross(inwards).normalized();
}

struct ValveMesh {
  SolidMesh mesh;
  Points unit;  ///< s, t, w of every node
  std::vector<int> clamped, middle, coaptation;
  Vec3 coaptation_normal{-std::sin(M_PI / 3), std::cos(M_PI / 3), 0};
  std::vector<SolidFace> aortic;
  std::vector<int> probes;  ///< on the aortic face, away from the supports
};

/// n x n elements over the leaflet, `layers` through its thickness; n a multiple of 4 (of 2: quadratic ones).
inline ValveMesh valve_mesh(const ClosedValve& valve, Shape shape, int n, int layers) {
  ValveMesh m;
  m.mesh = solid_box(
      shape, {n, n, layers}, [](const Vec3& u) { return u; }, Cut::mirrored);
  m.unit = m.mesh.reference;
  for (std::size_t a = 0; a < m.unit.size(); ++a) m.mesh.reference[a] = valve_point(valve, m.unit[a]);
  const auto at = [](double value, double where) { return std::abs(value - where) < 1e-9; };
  for (int a = 0; a < static_cast<int>(m.unit.size()); ++a) {
    const Vec3& u = m.unit[a];
    if (at(u.y(), 0) || at(u.x(), 1))
      m.clamped.push_back(a);
    else {
      if (at(u.x(), 0)) m.middle.push_back(a);
      if (at(u.y(), 1)) m.coaptation.push_back(a);
    }
  }
  for (SolidFace& face : boundary_faces(m.mesh))
    if (std::all_of(face.nodes.begin(), face.nodes.end(), [&](int a) { return at(m.unit[a].z(), 1); }))
      m.aortic.push_back(std::move(face));
  for (const Vec3& where : {Vec3(0, 0.5, 1), Vec3(0.5, 0.5, 1), Vec3(0, 0.75, 1), Vec3(0.5, 1, 1)})
    m.probes.push_back(static_cast<int>(std::min_element(m.unit.begin(), m.unit.end(),
                                                         [&](const Vec3& a, const Vec3& b) {
                                                           return (a - where).norm() < (b - where).norm();
                                                         }) -
                                        m.unit.begin()));
  return m;
}

inline std::shared_ptr<const materials::SolidLaw> valve_law(const ClosedValve& valve) {
  return std::make_shared<materials::SolidLaw>(
      std::make_shared<materials::NeoHookean>(valve.shear_Pa),
      materials::Volumetric{materials::Volumetric::Form::quadratic, valve.bulk_Pa});
}

struct ValveScene {
  ValveMesh valve;
  System system;
  std::shared_ptr<Solid> solid;
  std::vector<std::shared_ptr<ForceTerm>> terms;

  ValveScene(const ClosedValve& v, ValveMesh mesh, Formulation formulation) : valve(std::move(mesh)) {
    solid = std::make_shared<Solid>(valve.mesh, valve_law(v), formulation);
    const Body body = system.add_body("leaflet", valve.mesh.reference, solid->lumped_mass(v.density));
    terms.push_back(std::make_shared<SolidTerm>(solid, body));
    const double full = v.pressure_Pa;
    terms.push_back(std::make_shared<SolidPressureTerm>("pressure", valve.aortic, body,
                                                        [full](double t) { return full * t; }));
    for (int a : valve.clamped) system.hold(a);
    for (int a : valve.middle) system.hold_along(a, Vec3::UnitY());
    for (int a : valve.coaptation) {
      system.hold_along(a, valve.coaptation_normal);
      if (valve.unit[a].x() < 1e-9) system.hold_along(a, Vec3::UnitX());  // on the axis
    }
  }

  Points displacements() const {
    Points u;
    for (int a : valve.probes) u.push_back(system.state.x[a] - valve.mesh.reference[a]);
    return u;
  }
};

}  // namespace valsalva::bench
