// What a solid does at its present positions: stress, forces, tangent.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.hpp"
#include "materials/voigt.hpp"
#include "structure/solid.hpp"

namespace valsalva::structure {

using materials::Derivatives;
using materials::ElasticResponse;

namespace {

// dE in Voigt order per nodal displacement.
void strain_matrix(const Mat3& f, const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>>& gradient,
                   Eigen::Matrix<double, 6, Eigen::Dynamic>& b) {
  for (int a = 0; a < gradient.cols(); ++a) {
    const Vec3 g = gradient.col(a);
    for (int m = 0; m < 6; ++m) {
      const auto [i, j] = materials::voigt_pair[m];
      const Vec3 row = i == j ? Vec3(g[i] * f.col(i)) : Vec3(g[j] * f.col(i) + g[i] * f.col(j));
      b.block<1, 3>(m, 3 * a) = row.transpose();
    }
  }
}

Mat3 cofactor(const Mat3& f) {
  Mat3 c;
  c.col(0) = f.col(1).cross(f.col(2));
  c.col(1) = f.col(2).cross(f.col(0));
  c.col(2) = f.col(0).cross(f.col(1));
  return c;
}

}  // namespace

// An element at its present positions: F and J at its points, and the pressure there when it is mixed.
struct Solid::Deformed {
  std::array<Mat3, most_points> f;
  std::array<double, most_points> j, pressure;
  std::array<double, most_points> bulk;  // dp/dJ at fixed averages
  double volumetric_energy = 0;
  Eigen::Matrix4d curvature = Eigen::Matrix4d::Zero();
};

Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> Solid::gradient(int element,
                                                                           const Point& p) const {
  return {gradients_.data() + p.gradient, 3, mesh_.offsets[element + 1] - mesh_.offsets[element]};
}

Solid::NodalPressure Solid::nodal_pressures(const Points& x, int offset) const {
  NodalPressure nodal;
  if (patches_.empty()) return nodal;
  std::vector<Eigen::Vector4d> volumes(elements(), Eigen::Vector4d::Zero());  // of the element's corners
  for_all(elements(), "element", 0, [&](int e) {
    if (!averaged(e)) return;
    const Deformed d = deform(x, offset, e, nodal);
    for (int q = 0; q < elements_[e].count; ++q) {
      const Point& p = points_[elements_[e].first + q];
      volumes[e] += p.weight * d.j[q] * p.modes;
    }
  });
  std::vector<double> volume(nodes(), 0.0);
  for (int e = 0; e < elements(); ++e)
    if (averaged(e))
      for (int c = 0; c < 4; ++c) volume[mesh_.nodes_of(e)[c]] += volumes[e][c];
  nodal.pressure.assign(nodes(), 0.0);
  nodal.curvature.assign(nodes(), 0.0);
  for (int a = 0; a < nodes(); ++a) {
    if (patches_[a].empty()) continue;
    const double share = patch_share(a);
    const materials::VolumetricResponse u = law_->volumetric(volume[a] / patch_volume_[a]);
    nodal.energy += share * patch_volume_[a] * u.energy;
    nodal.pressure[a] = share * u.first;
    nodal.curvature[a] = share * u.second / patch_volume_[a];
  }
  return nodal;
}

Solid::Deformed Solid::deform(const Points& x, int offset, int e, const NodalPressure& nodal) const {
  const Element& element = elements_[e];
  const auto nodes = mesh_.nodes_of(e);
  ElementPoints now(3, nodes.size());
  for (std::size_t a = 0; a < nodes.size(); ++a) now.col(a) = x[offset + nodes[a]];
  Deformed d;
  for (int q = 0; q < element.count; ++q) {
    d.f[q].noalias() = now * gradient(e, points_[element.first + q]).transpose();
    d.j[q] = d.f[q].determinant();
    if (!(d.j[q] > 0) || !std::isfinite(d.j[q]))
      throw NumericalFailure(
          "det F = {:.3g} at quadrature point {} (near ({:.4g}, {:.4g}, {:.4g}) mm); expected a positive one",
          d.j[q], q, now.row(0).mean(), now.row(1).mean(), now.row(2).mean());
  }
  if (averaged(e) && !nodal.pressure.empty()) {
    const double share = local_share(e);
    Eigen::Vector4d pressure;
    for (int c = 0; c < 4; ++c) pressure[c] = nodal.pressure[nodes[c]];
    for (int q = 0; q < element.count; ++q) {
      const Point& p = points_[element.first + q];
      d.pressure[q] = p.modes.dot(pressure);
      d.bulk[q] = 0;
      if (share == 0) continue;
      const materials::VolumetricResponse u = law_->volumetric(d.j[q]);
      d.pressure[q] += share * u.first;
      d.bulk[q] = share * u.second;
      d.volumetric_energy += share * p.weight * u.energy;
    }
  }
  if (element.modes == 0) return d;
  Eigen::Vector4d dilatation = Eigen::Vector4d::Zero(), pressure = Eigen::Vector4d::Zero();
  for (int q = 0; q < element.count; ++q) {
    const Point& p = points_[element.first + q];
    dilatation += p.weight * d.j[q] * p.modes;
  }
  for (int q = 0; q < element.count; ++q) {
    const Point& p = points_[element.first + q];
    const materials::VolumetricResponse u = law_->volumetric(p.modes.dot(dilatation));
    d.volumetric_energy += p.weight * u.energy;
    pressure += p.weight * u.first * p.modes;
    d.curvature += p.weight * u.second * p.modes * p.modes.transpose();
  }
  for (int q = 0; q < element.count; ++q) d.pressure[q] = points_[element.first + q].modes.dot(pressure);
  return d;
}

ElasticResponse Solid::respond(int e, const Deformed& d, int q, Derivatives wanted) const {
  const Element& element = elements_[e];
  const Mat3 c = d.f[q].transpose() * d.f[q];
  if (formulation_ == Formulation::displacement)
    return law_->respond(c, element.fibres, element.factor, wanted);
  ElasticResponse r = law_->distortional(c, element.fibres, element.factor, wanted);
  if (wanted == Derivatives::stress) {
    r.stress += d.pressure[q] * d.j[q] * c.inverse();
  } else {
    const materials::PressureStress p = materials::volumetric_stress(c, d.pressure[q]);
    r.stress += p.stress;
    r.tangent += p.tangent;
  }
  return r;
}

double Solid::element_forces(const Points& x, int offset, int e, const NodalPressure& nodal,
                             Vec3* force) const {
  const Element& element = elements_[e];
  const Deformed d = deform(x, offset, e, nodal);
  const int n = mesh_.offsets[e + 1] - mesh_.offsets[e];
  ElementPoints total = ElementPoints::Zero(3, n);
  double energy = d.volumetric_energy;
  for (int q = 0; q < element.count; ++q) {
    const Point& p = points_[element.first + q];
    const ElasticResponse r = respond(e, d, q, Derivatives::stress);
    energy += p.weight * r.energy;
    const Mat3 piola = p.weight * d.f[q] * r.stress;
    total.noalias() -= piola * gradient(e, p);
  }
  for (int a = 0; a < n; ++a) force[a] = total.col(a);
  return energy;
}

double Solid::add_forces(const Points& x, Points& f, int offset) const {
  const NodalPressure nodal = nodal_pressures(x, offset);
  thread_local std::vector<Vec3> storage;
  thread_local std::vector<double> energies;
  std::vector<Vec3>& slots = storage;  // the calling thread's own, seen by the team
  std::vector<double>& energy_of = energies;
  slots.resize(mesh_.connectivity.size());
  energy_of.resize(mesh_.shapes.size());
  for_all(elements(), "element", 0, [&](int e) {
    energy_of[e] = element_forces(x, offset, e, nodal, slots.data() + mesh_.offsets[e]);
  });
  double energy = nodal.energy;
  for (double part : energy_of) energy += part;
  for (std::size_t i = 0; i < slots.size(); ++i) f[offset + mesh_.connectivity[i]] += slots[i];
  return energy;
}

Eigen::MatrixXd Solid::element_tangent(const Points& x, int offset, int e, const NodalPressure& nodal) const {
  const Element& element = elements_[e];
  const Deformed d = deform(x, offset, e, nodal);
  const int n = mesh_.offsets[e + 1] - mesh_.offsets[e];
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  Eigen::Matrix<double, 6, Eigen::Dynamic> b(6, 3 * n), stressed(6, 3 * n);
  Eigen::MatrixXd dilatation = Eigen::MatrixXd::Zero(3 * n, element.modes);
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(n, n);
  const bool local = averaged(e) && local_share(e) > 0;
  for (int q = 0; q < element.count; ++q) {
    const Point& p = points_[element.first + q];
    const auto g = gradient(e, p);
    const ElasticResponse r = respond(e, d, q, Derivatives::tangent);
    strain_matrix(d.f[q], g, b);
    stressed.noalias() = p.weight * r.tangent * b;
    k.noalias() += b.transpose() * stressed;
    pull.noalias() += p.weight * g.transpose() * r.stress * g;
    if (element.modes == 0 && !local) continue;
    const ElementPoints slope = cofactor(d.f[q]) * g;  // dJ/dx
    const Eigen::Map<const Eigen::VectorXd> flat(slope.data(), 3 * n);
    for (int m = 0; m < element.modes; ++m) dilatation.col(m) += p.weight * p.modes[m] * flat;
    if (local) k.noalias() += p.weight * d.bulk[q] * flat * flat.transpose();
  }
  for (int a = 0; a < n; ++a)
    for (int c = 0; c < n; ++c) k.block<3, 3>(3 * a, 3 * c).diagonal().array() += pull(a, c);
  if (element.modes > 0)
    k.noalias() +=
        dilatation * d.curvature.topLeftCorner(element.modes, element.modes) * dilatation.transpose();
  return k;
}

template <class Use>
void Solid::for_each_patch(const Points& x, int offset, const NodalPressure& nodal, const Use& use) const {
  constexpr int batch = 256;
  std::vector<Eigen::VectorXd> slopes(batch);
  std::vector<int> slots;
  for (int first = 0; first < static_cast<int>(patches_.size()); first += batch) {
    const int count = std::min<int>(batch, static_cast<int>(patches_.size()) - first);
    for_all(count, "patch of node", first, [&](int i) {
      const int a = first + i;
      const std::vector<int>& around = patch_nodes_[a];
      Eigen::VectorXd& slope = slopes[i];
      slope.setZero(3 * static_cast<Eigen::Index>(around.size()));
      if (nodal.curvature[a] == 0) return;
      for (int e : patches_[a]) {
        const auto nodes = mesh_.nodes_of(e);
        const auto corner = std::find(nodes.begin(), nodes.begin() + 4, a) - nodes.begin();
        const Deformed d = deform(x, offset, e, nodal);
        ElementPoints g = ElementPoints::Zero(3, nodes.size());
        for (int q = 0; q < elements_[e].count; ++q) {
          const Point& p = points_[elements_[e].first + q];
          g.noalias() += p.weight * p.modes[corner] * cofactor(d.f[q]) * gradient(e, p);
        }
        for (std::size_t b = 0; b < nodes.size(); ++b)
          slope.segment<3>(3 * (std::lower_bound(around.begin(), around.end(), nodes[b]) - around.begin())) +=
              g.col(static_cast<Eigen::Index>(b));
      }
    });
    for (int i = 0; i < count; ++i) {
      if (nodal.curvature[first + i] == 0) continue;
      slots = patch_nodes_[first + i];
      for (int& b : slots) b += offset;
      use(slots, slopes[i], nodal.curvature[first + i]);
    }
  }
}

void Solid::add_tangent(const Points& x, BlockMatrix& out, int offset) const {
  const NodalPressure nodal = nodal_pressures(x, offset);
  const auto fill = [&](int e, BlockMatrix::Piece& piece) {
    const auto nodes = mesh_.nodes_of(e);
    piece.slots.assign(nodes.begin(), nodes.end());
    for (int& a : piece.slots) a += offset;
    piece.k = element_tangent(x, offset, e, nodal);
  };
  add_in_batches(elements(), out, fill, "element");
  for_each_patch(x, offset, nodal,
                 [&](const std::vector<int>& around, const Eigen::VectorXd& slope, double curvature) {
                   out.add_rank_one(around, slope, curvature);
                 });
}

void Solid::add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset) const {
  const NodalPressure nodal = nodal_pressures(x, offset);
  std::vector<double> rows(mesh_.connectivity.size());
  for_all(elements(), "element", 0, [&](int e) {
    const Eigen::VectorXd sums = element_tangent(x, offset, e, nodal).cwiseAbs().rowwise().sum();
    for (int a = 0; a < sums.size() / 3; ++a) rows[mesh_.offsets[e] + a] = sums.segment<3>(3 * a).maxCoeff();
  });
  for (std::size_t i = 0; i < rows.size(); ++i) bound[offset + mesh_.connectivity[i]] += rows[i];
  for_each_patch(x, offset, nodal,
                 [&](const std::vector<int>& around, const Eigen::VectorXd& slope, double curvature) {
                   const double total = std::abs(curvature) * slope.cwiseAbs().sum();
                   for (std::size_t b = 0; b < around.size(); ++b)
                     bound[around[b]] +=
                         total * slope.segment<3>(3 * static_cast<Eigen::Index>(b)).cwiseAbs().maxCoeff();
                 });
}

std::vector<SolidPoint> Solid::points_of(const Points& x, int e, int offset,
                                         const NodalPressure& nodal) const {
  const Element& element = elements_[e];
  const Deformed d = deform(x, offset, e, nodal);
  std::vector<SolidPoint> points;
  for (int q = 0; q < element.count; ++q) {
    const Point& p = points_[element.first + q];
    const ElasticResponse r = respond(e, d, q, Derivatives::stress);
    SolidPoint s;
    s.reference = p.reference;
    s.volume_mm3 = p.weight;
    s.deformation = d.f[q];
    s.cauchy_Pa = materials::cauchy_stress(d.f[q], r.stress);
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(s.cauchy_Pa, Eigen::EigenvaluesOnly);
    s.principal_Pa = principal.eigenvalues();
    const Mat3 deviator = s.cauchy_Pa - s.cauchy_Pa.trace() / 3 * Mat3::Identity();
    s.von_mises_Pa = std::sqrt(1.5) * deviator.norm();
    s.volume_ratio = d.j[q];
    const Eigen::SelfAdjointEigenSolver<Mat3> stretch(d.f[q].transpose() * d.f[q], Eigen::EigenvaluesOnly);
    s.stretch = stretch.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    s.exponent = r.exponent;
    s.energy_Pa = r.energy;
    points.push_back(s);
  }
  return points;
}

std::vector<SolidPoint> Solid::points_of(const Points& x, int element, int offset) const {
  return points_of(x, element, offset, nodal_pressures(x, offset));
}

std::vector<std::vector<SolidPoint>> Solid::all_points(const Points& x, int offset) const {
  const NodalPressure nodal = nodal_pressures(x, offset);
  std::vector<std::vector<SolidPoint>> all(elements());
  for_all(elements(), "element", 0, [&](int e) { all[e] = points_of(x, e, offset, nodal); });
  return all;
}

}  // namespace valsalva::structure
