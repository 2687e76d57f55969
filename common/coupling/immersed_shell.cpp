#include "coupling/immersed_shell.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "coupling/sampling.hpp"
#include "coupling/standoff.hpp"
#include "materials/capped_exponential.hpp"

namespace valsalva::coupling {

namespace {

void sum_over_ranks(MPI_Comm comm, int ranks, Points& values) {
  if (ranks > 1 && !values.empty()) mpi::sum_in_place(comm, values[0].data(), 3 * values.size());
}

}  // namespace

ImmersedShell::ImmersedShell(MPI_Comm comm, structure::Shell shell, Points rest, Points start,
                             std::vector<std::uint8_t> clamped, std::vector<int> group,
                             const Spacing& spacing)
    : comm_(comm),
      part_{mpi::rank(comm), mpi::size(comm)},
      shell_(std::move(shell)),
      tangent_(shell_, part_),
      standoff_(spacing.standoff_mm),
      near_(std::max(spacing.repulsion.range_mm, spacing.standoff_mm), std::move(rest), start,
            std::move(group)),
      repulsion_(spacing.repulsion, shell_.lumped_area()),
      x_(std::move(start)),
      clamped_(std::move(clamped)) {
  VALSALVA_ASSERT(x_.size() == static_cast<std::size_t>(shell_.nodes()) && clamped_.size() == x_.size());
  const std::vector<Edge> edges = edges_of(cells_of(shell_.mesh().triangles));
  const std::size_t from = edges.size() * part_.index / part_.count,
                    to = edges.size() * (part_.index + 1) / part_.count;
  edges_.assign(edges.begin() + static_cast<long>(from), edges.begin() + static_cast<long>(to));
  const Points& reference = shell_.mesh().reference;
  for (const auto& [a, b] : edges_)
    square_of_reference_.push_back((reference[a] - reference[b]).squaredNorm());
  ahead_ = x_;
  moved();
}

void ImmersedShell::set_x(Points x) {
  VALSALVA_ASSERT(x.size() == x_.size());
  x_ = std::move(x);
  ahead_ = x_;
  moved();
}

void ImmersedShell::moved() {
  pairs_ = &near_.find(x_);
  coupled_ = x_;
  if (!(standoff_ > 0) || pairs_->empty()) return;
  Points normal(x_.size(), Vec3::Zero());
  for (const Triangle& t : shell_.mesh().triangles) {
    const Vec3 twice_area = (x_[t[1]] - x_[t[0]]).cross(x_[t[2]] - x_[t[0]]);
    for (int a : t) normal[a] += twice_area;
  }
  stand_off(standoff_, x_, normal, *pairs_, coupled_);
}

void ImmersedShell::begin_step(double dt, const Points& last_velocity, double lead) {
  ahead_ = x_;
  for (std::size_t a = 0; a < x_.size(); ++a)
    if (!clamped_[a]) ahead_[a] += lead * dt * last_velocity[a];
}

void ImmersedShell::forces(Points& out) {
  out.assign(x_.size(), Vec3::Zero());
  double exponent = 0;
  shell_.add_forces(ahead_, out, 0, part_, &exponent);
  sum_over_ranks(comm_, part_.count, out);
  if (part_.count > 1) exponent = mpi::max(comm_, exponent);
  modulus_before_ = modulus_;
  modulus_ = (1 + 2 * exponent) * materials::capped_exponential<double>(exponent).value;
  if (tangent_is_new_) modulus_of_tangent_ = modulus_;
  tangent_is_new_ = false;
  pull_.setZero();
  for (std::size_t a = 0; a < x_.size(); ++a)
    if (clamped_[a]) pull_ += out[a];
  repulsion_.add_forces(x_, *pairs_, out);
  for (std::size_t a = 0; a < x_.size(); ++a)
    if (clamped_[a]) out[a].setZero();
}

void ImmersedShell::update_tangent() {
  tangent_.update(x_);
  tangent_is_new_ = true;
  Points ignored(x_.size(), Vec3::Zero());
  repulsion_.add_forces(x_, *pairs_, ignored);
}

void ImmersedShell::tangent_product(const Points& direction, Points& out) const {
  free_direction_ = direction;
  for (std::size_t a = 0; a < x_.size(); ++a)
    if (clamped_[a]) free_direction_[a].setZero();
  out.assign(x_.size(), Vec3::Zero());
  tangent_.apply(free_direction_, out);
  sum_over_ranks(comm_, part_.count, out);
  repulsion_.add_tangent_product(free_direction_, out);
  for (std::size_t a = 0; a < x_.size(); ++a)
    if (clamped_[a]) out[a].setZero();
}

void ImmersedShell::move(Points& velocity, double dt) {
  for (std::size_t a = 0; a < x_.size(); ++a) {
    if (clamped_[a]) continue;
    if (!(velocity[a].norm() < fastest_mm_per_s))
      throw NumericalFailure(
          "coupling: leaflet node {} at ({:.3g}, {:.3g}, {:.3g}) mm moves at {:.4g} mm/s, faster than {} "
          "mm/s",
          a, x_[a].x(), x_[a].y(), x_[a].z(), velocity[a].norm(), fastest_mm_per_s);
    x_[a] += dt * velocity[a];
  }
  moved();
}

double ImmersedShell::stiffening(double strain) const {
  // d2W/de2 of the laws with exponentials grows like (1 + 2 Q) exp Q. The last forces are those of the step
  // before.
  const double growing = std::max(1.0, modulus_ / modulus_before_);
  return std::max(modulus_ * growing / modulus_of_tangent_, 1 + 10 * strain);
}

std::map<std::string, state::Array> ImmersedShell::save() const {
  std::map<std::string, state::Array> arrays;
  arrays["coupling/body/modulus"] = state::Array::of(
      std::vector<double>{modulus_, modulus_before_, modulus_of_tangent_, tangent_is_new_ ? 1.0 : 0.0});
  return arrays;
}

void ImmersedShell::load(const state::State& state) {
  const char* name = "coupling/body/modulus";
  const std::vector<double>& values = state.array(name).doubles(name);
  if (values.size() != 4)
    throw InputError("{}: {} has {} entries, expected 4", state.source, name, values.size());
  modulus_ = values[0];
  modulus_before_ = values[1];
  modulus_of_tangent_ = values[2];
  tangent_is_new_ = values[3] != 0;
}

EdgeStretch ImmersedShell::edge_stretch(const Points& since) const {
  std::array<double, 2> most{0, 0};  // of squares: over the reference, change
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto [a, b] = edges_[i];
    const double now = (x_[a] - x_[b]).squaredNorm(), then = (since[a] - since[b]).squaredNorm();
    most[0] = std::max(most[0], now / square_of_reference_[i]);
    most[1] = std::max(most[1], std::abs(now - then) / then);
  }
  if (part_.count > 1) mpi::max_in_place(comm_, most.data(), most.size());
  return {std::sqrt(most[0]), 0.5 * most[1]};
}

}  // namespace valsalva::coupling
