#include "structure/beam.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {

std::vector<Vec3> radial_directions(const Points& reference, const std::vector<Edge>& elements) {
  std::vector<Vec3> axes;
  axes.reserve(elements.size());
  for (const Edge& e : elements) {
    Vec3 radial = 0.5 * (reference[e[0]] + reference[e[1]]);
    radial.z() = 0;
    axes.push_back(radial.norm() > 1e-9 ? Vec3(radial.normalized()) : Vec3(Vec3::UnitX()));
  }
  return axes;
}

double torsion_constant(double width_mm, double depth_mm) {
  const double b = std::max(width_mm, depth_mm), d = std::min(width_mm, depth_mm);
  return b * d * d * d * (1.0 / 3 - 0.21 * d / b * (1 - std::pow(d / b, 4) / 12));
}

// What the angles are made of: the chord p, the triads of both ends, and the sines of the angles.
struct BeamNetwork::Sines {
  Vec3 p;
  double length;
  Mat3 a, b;
  double az, ay, bz, by, twist;
};

namespace {

double arcsine(double s) {
  return std::asin(std::clamp(s, -1.0, 1.0));
}

// d asin(s)/ds, kept finite where an end stands square to the chord.
double arcsine_slope(double s) {
  return 1 / std::sqrt(std::max(1 - s * s, 1e-6));
}

}  // namespace

BeamNetwork::Sines BeamNetwork::sines(const Points& x, const std::vector<Eigen::Quaterniond>& rotation,
                                      int element, int offset, int rotation_offset) const {
  const Edge& e = mesh_.elements[element];
  return sines(x[offset + e[0]], x[offset + e[1]], rotation[rotation_offset + e[0]],
               rotation[rotation_offset + e[1]], element);
}

BeamNetwork::Sines BeamNetwork::sines(const Vec3& xa, const Vec3& xb, const Eigen::Quaterniond& ra,
                                      const Eigen::Quaterniond& rb, int element) const {
  const Mat3& axes = elements_[element].axes;
  Sines s;
  const Vec3 chord = xb - xa;
  s.length = chord.norm();
  s.p = chord / s.length;
  s.a = ra.toRotationMatrix() * axes;
  s.b = rb.toRotationMatrix() * axes;
  s.az = -s.p.dot(s.a.col(1));
  s.ay = s.p.dot(s.a.col(2));
  s.bz = -s.p.dot(s.b.col(1));
  s.by = s.p.dot(s.b.col(2));
  s.twist = 0.5 * (s.a.col(2).dot(s.b.col(1)) - s.a.col(1).dot(s.b.col(2)));
  return s;
}

BeamNetwork::Angles BeamNetwork::angles_of(const Sines& s) {
  return {s.length, arcsine(s.az), arcsine(s.ay), arcsine(s.bz), arcsine(s.by), arcsine(s.twist)};
}

BeamNetwork::BeamNetwork(BeamMesh mesh, const BeamMaterial& material) : mesh_(std::move(mesh)) {
  const std::size_t count = mesh_.elements.size();
  VALSALVA_ASSERT(mesh_.width_mm.size() == count && mesh_.depth_mm.size() == count &&
                  mesh_.depth_axis.size() == count &&
                  (mesh_.torsion_mm4.empty() || mesh_.torsion_mm4.size() == count) &&
                  (mesh_.shear_area_mm2.empty() || mesh_.shear_area_mm2.size() == count));
  double young = material.young_Pa, poisson = material.poisson, shear = young / (2 * (1 + poisson));
  if (material.superelastic) {
    fibres_.emplace(*material.superelastic, material.fibres);
    austenite_.resize(material.fibres.per_element());
    young = material.superelastic->stiffest_Pa();  // of the stiffness bound
    poisson = material.superelastic->parameters().poisson;
    shear = material.superelastic->parameters().austenite_Pa / (2 * (1 + poisson));
  }
  if (!(young > 0) || !(material.density_g_per_mm3 > 0) || !(poisson > -1) || !(poisson <= 0.5))
    throw InputError(
        "beams: Young's modulus {} Pa, density {} g/mm3, Poisson's ratio {}; expected positive, "
        "positive, and -1 to 0.5",
        young, material.density_g_per_mm3, poisson);
  if (fibres_ && !mesh_.shear_area_mm2.empty())
    throw InputError("beams: superelastic sections have no shear flexibility; leave the shear area out");
  const std::vector<Eigen::Quaterniond> identity(mesh_.reference.size(), Eigen::Quaterniond::Identity());
  elements_.resize(count);
  double total_length = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Edge& e = mesh_.elements[i];
    for (int a : e)
      if (a < 0 || a >= nodes())
        throw InputError("beams: element {} refers to node {}; the mesh has {} nodes", i, a, nodes());
    const double width = mesh_.width_mm[i], depth = mesh_.depth_mm[i];
    if (!(width > 0) || !(depth > 0) || !std::isfinite(width * depth))
      throw InputError("beams: section of element {} is {} x {} mm; expected positive", i, width, depth);
    Element& element = elements_[i];
    const Vec3 chord = mesh_.reference[e[1]] - mesh_.reference[e[0]];
    element.length = chord.norm();
    if (!(element.length > 1e-9))
      throw InputError("beams: element {} (nodes {} and {}) has no length; merge its nodes", i, e[0], e[1]);
    const Vec3 along = chord / element.length;
    Vec3 depth_axis = mesh_.depth_axis[i] - mesh_.depth_axis[i].dot(along) * along;
    if (!(depth_axis.norm() > 1e-3))
      throw InputError("beams: the depth axis of element {} is parallel to it; give another direction", i);
    depth_axis.normalize();
    element.axes << along, depth_axis.cross(along), depth_axis;
    element.axial = young * width * depth / element.length;
    element.bend_z = young * depth * width * width * width / 12 / element.length;
    element.bend_y = young * width * depth * depth * depth / 12 / element.length;
    const double torsion = mesh_.torsion_mm4.empty() ? torsion_constant(width, depth) : mesh_.torsion_mm4[i];
    if (!(torsion > 0) || !std::isfinite(torsion))
      throw InputError("beams: torsion constant of element {} is {} mm4; expected positive", i, torsion);
    element.torsion = shear * torsion / element.length;
    if (!mesh_.shear_area_mm2.empty()) {
      const double area = mesh_.shear_area_mm2[i];
      if (!(area > 0))
        throw InputError("beams: shear area of element {} is {} mm2; expected positive", i, area);
      const auto slopes = [&](double bend) {
        const double phi = 12 * bend / (shear * area * element.length);
        return Slopes{(4 + phi) / (1 + phi), (2 - phi) / (1 + phi)};
      };
      element.slopes_z = slopes(element.bend_z);
      element.slopes_y = slopes(element.bend_y);
    }
    element.mass = material.density_g_per_mm3 * width * depth * element.length;
    element.rest = angles_of(sines(mesh_.reference, identity, static_cast<int>(i), 0, 0));
    total_length += element.length;
  }
  coupling_length_ = count ? total_length / static_cast<double>(count) : 1;
}

std::vector<double> BeamNetwork::lumped_mass() const {
  std::vector<double> mass(nodes(), 0.0);
  for (int i = 0; i < elements(); ++i)
    for (int a : mesh_.elements[i]) mass[a] += 0.5 * elements_[i].mass;
  return mass;
}

std::vector<double> BeamNetwork::lumped_inertia() const {
  std::vector<double> inertia(nodes(), 0.0);
  for (int i = 0; i < elements(); ++i) {
    const double length = elements_[i].length;
    const double section = mesh_.width_mm[i] * mesh_.width_mm[i] + mesh_.depth_mm[i] * mesh_.depth_mm[i];
    const double gyration2 = std::max(length * length, section) / 12;
    for (int a : mesh_.elements[i]) inertia[a] += 0.5 * elements_[i].mass * gyration2;
  }
  return inertia;
}

FibreHistory BeamNetwork::rest() const {
  FibreHistory history;
  if (fibres_) history.fibre.resize(static_cast<std::size_t>(elements()) * fibres_->grid().per_element());
  return history;
}

const materials::SuperelasticState* BeamNetwork::fibres_of(const FibreHistory* history, int element) const {
  if (!history) return austenite_.data();
  return history->fibre.data() + static_cast<std::size_t>(element) * fibres_->grid().per_element();
}

double BeamNetwork::add_forces(const Points& x, const std::vector<Eigen::Quaterniond>& rotation,
                               Points& force, Points& moment, int offset, int rotation_offset,
                               const FibreHistory* history) const {
  double energy = 0;
  BeamMeasures section_force;
  for (int i = 0; i < elements(); ++i) {
    const Edge& e = mesh_.elements[i];
    const Sines s = sines(x, rotation, i, offset, rotation_offset);
    energy += section(measures(s, i), i, history, section_force, nullptr);
    const Ends ends = on_ends(s, section_force);
    for (int a = 0; a < 2; ++a) {
      force[offset + e[a]] += ends.force[a];
      moment[rotation_offset + e[a]] += ends.moment[a];
    }
  }
  return energy;
}

void BeamNetwork::advance(const Points& x, const std::vector<Eigen::Quaterniond>& rotation,
                          FibreHistory& history, int offset, int rotation_offset) const {
  if (!fibres_) return;
  const int count = fibres_->grid().per_element();
  for (int i = 0; i < elements(); ++i) {
    materials::SuperelasticState* own = history.fibre.data() + static_cast<std::size_t>(i) * count;
    const BeamMeasures q = measures(sines(x, rotation, i, offset, rotation_offset), i);
    history.dissipated_nJ += fibres_->respond(shape(i), q, own, own, false).dissipated_nJ;
  }
}

BeamMeasures BeamNetwork::measures(const Sines& s, int i) const {
  const Angles now = angles_of(s);
  const Angles& rest = elements_[i].rest;
  return (BeamMeasures() << now.length - rest.length, now.az - rest.az, now.bz - rest.bz, now.ay - rest.ay,
          now.by - rest.by, now.twist - rest.twist)
      .finished();
}

double BeamNetwork::section(const BeamMeasures& q, int i, const FibreHistory* history, BeamMeasures& force,
                            BeamStiffness* stiffness) const {
  const Element& k = elements_[i];
  const double torque = k.torsion * q[5];
  if (fibres_) {
    FibreSection::Response r =
        fibres_->respond(shape(i), q, fibres_of(history, i), nullptr, stiffness != nullptr);
    force = r.force;
    force[5] = torque;
    if (stiffness) {
      *stiffness = r.stiffness;
      (*stiffness)(5, 5) = k.torsion;
    }
    return r.stored_nJ + 0.5 * torque * q[5];
  }
  const Slopes &z = k.slopes_z, &y = k.slopes_y;
  force << k.axial * q[0], k.bend_z * (z.near * q[1] + z.far * q[2]),
      k.bend_z * (z.near * q[2] + z.far * q[1]), k.bend_y * (y.near * q[3] + y.far * q[4]),
      k.bend_y * (y.near * q[4] + y.far * q[3]), torque;
  if (stiffness) {
    BeamStiffness& d = *stiffness;
    d.setZero();
    d(0, 0) = k.axial;
    d(1, 1) = d(2, 2) = k.bend_z * z.near;
    d(1, 2) = d(2, 1) = k.bend_z * z.far;
    d(3, 3) = d(4, 4) = k.bend_y * y.near;
    d(3, 4) = d(4, 3) = k.bend_y * y.far;
    d(5, 5) = k.torsion;
  }
  return 0.5 * force.dot(q);
}

BeamNetwork::Ends BeamNetwork::on_ends(const Sines& s, const BeamMeasures& f) {
  // Derivatives of the energy with respect to the sines.
  const double daz = f[1] * arcsine_slope(s.az), dbz = f[2] * arcsine_slope(s.bz);
  const double day = f[3] * arcsine_slope(s.ay), dby = f[4] * arcsine_slope(s.by);
  const double dtwist = f[5] * arcsine_slope(s.twist);
  // dU/dp, without the part along p, divided by l: dU/dx_b.
  const Vec3 dp = -daz * s.a.col(1) + day * s.a.col(2) - dbz * s.b.col(1) + dby * s.b.col(2);
  const Vec3 dx = f[0] * s.p + (dp - dp.dot(s.p) * s.p) / s.length;
  // d(p . t)/d(rotation of t) = t x p; the twist likewise.
  const Vec3 ma = -daz * s.a.col(1).cross(s.p) + day * s.a.col(2).cross(s.p) +
                  0.5 * dtwist * (s.a.col(2).cross(s.b.col(1)) - s.a.col(1).cross(s.b.col(2)));
  const Vec3 mb = -dbz * s.b.col(1).cross(s.p) + dby * s.b.col(2).cross(s.p) +
                  0.5 * dtwist * (s.b.col(1).cross(s.a.col(2)) - s.b.col(2).cross(s.a.col(1)));
  return {{dx, Vec3(-dx)}, {Vec3(-ma), Vec3(-mb)}};
}

void BeamNetwork::add_tangent(const Points& x, const std::vector<Eigen::Quaterniond>& rotation,
                              BlockMatrix& out, int offset, int rotation_offset,
                              const FibreHistory* history) const {
  using Vector12 = Eigen::Matrix<double, 12, 1>;  // a, b, spin of a, spin of b
  const auto stacked = [](const Ends& f) {
    return (Vector12() << f.force[0], f.force[1], f.moment[0], f.moment[1]).finished();
  };
  for (int i = 0; i < elements(); ++i) {
    const Edge& e = mesh_.elements[i];
    const Sines s = sines(x, rotation, i, offset, rotation_offset);
    BeamMeasures force;
    BeamStiffness stiffness;
    section(measures(s, i), i, history, force, &stiffness);
    Eigen::Matrix<double, 12, 6> gradient;  // of the measures
    for (int m = 0; m < 6; ++m) gradient.col(m) = -stacked(on_ends(s, BeamMeasures::Unit(m)));
    Eigen::MatrixXd k = gradient * stiffness * gradient.transpose();
    for (int column = 0; column < 12; ++column) {
      const int end = column / 3 % 2, axis = column % 3;
      const double step = 1e-6 * (column < 6 ? elements_[i].length : 1);
      Vector12 ends[2];
      for (int side = 0; side < 2; ++side) {
        const double change = side == 0 ? step : -step;
        std::array<Vec3, 2> at{x[offset + e[0]], x[offset + e[1]]};
        std::array<Eigen::Quaterniond, 2> turn{rotation[rotation_offset + e[0]],
                                               rotation[rotation_offset + e[1]]};
        if (column < 6)
          at[end][axis] += change;
        else
          turn[end] = Eigen::AngleAxisd(change, Vec3::Unit(axis)) * turn[end];
        ends[side] = stacked(on_ends(sines(at[0], at[1], turn[0], turn[1], i), force));
      }
      k.col(column) += (ends[1] - ends[0]) / (2 * step);
    }
    const std::array<int, 4> slots{offset + e[0], offset + e[1], out.slot_of_rotation(rotation_offset + e[0]),
                                   out.slot_of_rotation(rotation_offset + e[1])};
    out.add(slots, k);
  }
}

void BeamNetwork::add_stiffness_bound(const Points& x, StiffnessBound& out, int offset,
                                      int rotation_offset) const {
  // Absolute row sums of the linear element's matrix, a rotation counted as an arc of coupling_length_; plus
  // the geometric stiffness of the axial force.
  for (int i = 0; i < elements(); ++i) {
    const Edge& e = mesh_.elements[i];
    const Element& k = elements_[i];
    const double bend = std::max(k.bend_z, k.bend_y);
    const double length = (x[offset + e[1]] - x[offset + e[0]]).norm();
    const double tension = k.axial * std::abs(length - k.length) / length;
    const double translation = 2 * std::max(k.axial, 12 * bend / (k.length * k.length)) + 2 * tension +
                               12 * bend / (k.length * coupling_length_);
    const double rotation = std::max(6 * bend, 2 * k.torsion) + 12 * bend / k.length * coupling_length_;
    for (int a : e) {
      out.translation[offset + a] += translation;
      out.rotation[rotation_offset + a] += rotation;
    }
  }
}

BeamState BeamNetwork::element_state(const Points& x, const std::vector<Eigen::Quaterniond>& rotation, int i,
                                     int offset, int rotation_offset) const {
  const Element& k = elements_[i];
  const Angles now = angles_of(sines(x, rotation, i, offset, rotation_offset));
  const double az = now.az - k.rest.az, bz = now.bz - k.rest.bz;
  const double ay = now.ay - k.rest.ay, by = now.by - k.rest.by;
  const auto curvature = [&](const Slopes& m, double near, double far) {  // M_a / EI
    return std::abs(m.near * near + m.far * far) / k.length;
  };
  const double width = 0.5 * mesh_.width_mm[i], depth = 0.5 * mesh_.depth_mm[i];
  const double bending =
      std::max(curvature(k.slopes_z, az, bz) * width + curvature(k.slopes_y, ay, by) * depth,
               curvature(k.slopes_z, bz, az) * width + curvature(k.slopes_y, by, ay) * depth);
  const double axial = (now.length - k.rest.length) / k.length;
  return {axial, std::abs(axial) + bending};
}

BeamTerm::BeamTerm(std::shared_ptr<const BeamNetwork> network, const Body& body, FibreHistory history)
    : network_(std::move(network)), body_(body), history_(std::move(history)) {
  VALSALVA_ASSERT(body_.rotational() && body_.count == network_->nodes());
  const FibreHistory rest = network_->rest();
  if (history_.fibre.empty()) {
    history_ = rest;
  } else if (history_.fibre.size() != rest.fibre.size()) {
    throw InputError(
        "body '{}': the state remembers {} superelastic fibres, the body has {}; the law or its number of "
        "fibres has been changed since: start from the stage before",
        body_.name, history_.fibre.size(), rest.fibre.size());
  }
}

double BeamTerm::largest_martensite() const {
  double most = 0;
  for (const materials::SuperelasticState& fibre : history_.fibre)
    most = std::max(most, std::abs(fibre.martensite));
  return most;
}

Snapshot BeamTerm::save() const {
  if (!network_->superelastic()) return {};
  Snapshot s;
  std::vector<double>&martensite = s["martensite"], &stress = s["stress_Pa"];
  martensite.reserve(history_.fibre.size());
  stress.reserve(history_.fibre.size());
  for (const materials::SuperelasticState& fibre : history_.fibre) {
    martensite.push_back(fibre.martensite);
    stress.push_back(fibre.stress_Pa);
  }
  s["dissipated_nJ"] = {history_.dissipated_nJ};
  return s;
}

void BeamTerm::restore(const Snapshot& snapshot) {
  if (!network_->superelastic()) return;
  const auto entry = [&](const char* name, std::size_t size) -> const std::vector<double>& {
    const auto found = snapshot.find(name);
    if (found == snapshot.end() || found->second.size() != size)
      throw InputError(
          "body '{}': the state has no '{}' of {} superelastic fibres; it was written with another law: "
          "start "
          "the stage anew",
          body_.name, name, size);
    return found->second;
  };
  const std::vector<double>& martensite = entry("martensite", history_.fibre.size());
  const std::vector<double>& stress = entry("stress_Pa", history_.fibre.size());
  for (std::size_t i = 0; i < history_.fibre.size(); ++i) history_.fibre[i] = {martensite[i], stress[i]};
  history_.dissipated_nJ = entry("dissipated_nJ", 1)[0];
}

}  // namespace valsalva::structure
