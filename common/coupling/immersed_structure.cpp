#include "coupling/immersed_structure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"

namespace valsalva::coupling {

using structure::Configuration;
using structure::Forces;

namespace {

constexpr double difference_share = 1e-6;  // of the shortest edge; in radians for rotations
constexpr const char* prefix = "coupling/body/";

Eigen::Quaterniond turn_by(const Vec3& spin) {
  const double angle = spin.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, spin / angle));
}

}  // namespace

void add_excess_mass(const structure::System& system, const structure::Body& body, double density_g_per_mm3,
                     double fluid_density_g_per_mm3, std::vector<double>& excess_mass_g) {
  if (!(density_g_per_mm3 >= fluid_density_g_per_mm3))
    throw InputError(
        "coupling: body '{}' has the density {} g/mm3, less than the fluid's {}; an immersed body must not "
        "be "
        "lighter than the fluid",
        body.name, density_g_per_mm3, fluid_density_g_per_mm3);
  excess_mass_g.resize(system.nodes(), 0.0);
  for (int a = body.begin(); a < body.end(); ++a)
    excess_mass_g[a] = system.mass(a) * (1 - fluid_density_g_per_mm3 / density_g_per_mm3);
}

ImmersedStructure::ImmersedStructure(std::unique_ptr<structure::System> system,
                                     std::vector<std::shared_ptr<structure::ForceTerm>> terms,
                                     const Points& reference, const ImmersedStructureSettings& settings)
    : ImmersedStructure(*system, std::move(terms), reference, settings) {
  owned_ = std::move(system);
}

ImmersedStructure::ImmersedStructure(structure::System& system,
                                     std::vector<std::shared_ptr<structure::ForceTerm>> terms,
                                     const Points& reference, const ImmersedStructureSettings& settings)
    : system_(&system),
      terms_(std::move(terms)),
      settings_(settings),
      edges_(edges_of(settings.cells)),
      shortest_(std::numeric_limits<double>::infinity()) {
  VALSALVA_ASSERT(reference.size() == system_->nodes());
  if (edges_.empty()) throw InputError("coupling: an immersed structure without elements");
  for (const Edge& e : edges_) {
    rest_length_.push_back((reference[e[0]] - reference[e[1]]).norm());
    shortest_ = std::min(shortest_, rest_length_.back());
    if (!(shortest_ > 0))
      throw InputError("coupling: the nodes {} and {} of one element coincide in the reference", e[0], e[1]);
  }
  const std::vector<double>& excess = settings_.excess_mass_g;
  if (!excess.empty() && excess.size() != system_->nodes())
    throw InputError("coupling: {} excess masses for {} nodes", excess.size(), system_->nodes());
  for (std::size_t a = 0; a < excess.size(); ++a) {
    if (!(excess[a] >= 0))
      throw InputError("coupling: {} has the excess mass {} g; expected zero or a positive one",
                       system_->describe(static_cast<int>(a)), excess[a]);
    if (excess[a] > 0) twin_of_.push_back(static_cast<int>(a));
  }
  if (!twin_of_.empty() && !(settings_.tie_rate_per_s > 0))
    throw InputError(
        "coupling: a tie rate of {} 1/s for bodies heavier than the fluid; expected a positive one",
        settings_.tie_rate_per_s);
  if (!(settings_.rotation_damping_per_s >= 0))
    throw InputError("coupling: a damping of rotations of {} 1/s; expected zero or a positive one",
                     settings_.rotation_damping_per_s);
  const Configuration& start = system_->state;
  for (int a : twin_of_) {
    twin_.push_back(start.x[a]);
    twin_velocity_.push_back(start.v[a]);
  }
  bool any_held = false;
  for (std::size_t a = 0; a < system_->nodes(); ++a) {
    held_.push_back(system_->held_directions(static_cast<int>(a)));
    any_held = any_held || held_.back() != Mat3::Zero();
  }
  if (!any_held) held_.clear();
  volumes_.emplace(settings_.cells, start.x, held_);
  if (settings_.sampling_mm) sampling_.emplace(settings_.cells, reference, *settings_.sampling_mm);
  structure::StiffnessBound bound;
  bound.reset(system_->nodes(), system_->rotational_nodes());
  for (const auto& term : terms_) {
    if (term->stiffness_is_abrupt()) {
      abrupt_.push_back(term);
    } else {
      term->add_stiffness_bound(start, bound);
    }
  }
  elastic_stiffness_ = *std::max_element(bound.translation.begin(), bound.translation.end());
  ahead_ = system_->state;
  moved();
}

double ImmersedStructure::abrupt_stiffness() const {
  structure::StiffnessBound bound;
  bound.reset(system_->nodes(), system_->rotational_nodes());
  for (const auto& term : abrupt_) term->add_stiffness_bound(system_->state, bound);
  return *std::max_element(bound.translation.begin(), bound.translation.end());
}

double ImmersedStructure::stiffening(double strain) const {
  constexpr double growth = 1.2, of_elastic = 0.1;
  if (!abrupt_.empty() && abrupt_stiffness() > growth * probed_stiffness_ + of_elastic * elastic_stiffness_)
    return std::numeric_limits<double>::infinity();
  return ImmersedBody::stiffening(strain);
}

void ImmersedStructure::moved() {
  if (sampling_) sampling_->locate(system_->state.x);
  if (keeps_volume()) volumes_->update(system_->state.x);
}

void ImmersedStructure::set_x(Points x) {
  VALSALVA_ASSERT(x.size() == system_->nodes());
  system_->state.x = std::move(x);
  ahead_ = system_->state;
  moved();
}

Vec3 ImmersedStructure::free_part(int node, const Vec3& v) const {
  return held_.empty() ? v : Vec3(v - held_[node] * v);
}

std::vector<double> ImmersedStructure::own_masses() const {
  std::vector<double> masses;
  for (int a : twin_of_) masses.push_back(settings_.excess_mass_g[a]);
  masses.insert(masses.end(), system_->inertias().begin(), system_->inertias().end());
  return masses;
}

double ImmersedStructure::term_forces(const Configuration& at, Forces& out) const {
  out.reset(system_->nodes(), system_->rotational_nodes());
  double energy = 0;
  for (const auto& term : terms_) energy += term->add_forces(at, out);
  return energy;
}

void ImmersedStructure::begin_step(double dt_s, const Points& last_velocity, double lead) {
  for (const auto& term : terms_) term->begin_step(system_->state, dt_s);
  ahead_ = system_->state;
  for (std::size_t a = 0; a < ahead_.x.size(); ++a) ahead_.x[a] += lead * dt_s * last_velocity[a];
}

Vec3 ImmersedStructure::tie_force(std::size_t twin) const {
  const int a = twin_of_[twin];
  return settings_.excess_mass_g[a] * settings_.tie_rate_per_s * settings_.tie_rate_per_s *
         (twin_[twin] - x()[a]);
}

void ImmersedStructure::leave_out_constraints(Points& force) const {
  if (!keeps_volume()) return;
  for (std::size_t t = 0; t < twin_of_.size(); ++t) force[twin_of_[t]] += tie_force(t);
  volumes_->constrain_force(force);
  for (std::size_t t = 0; t < twin_of_.size(); ++t) force[twin_of_[t]] -= tie_force(t);
}

void ImmersedStructure::forces(Points& out) {
  const std::size_t nodes = system_->nodes();
  stored_ = term_forces(ahead_, here_);
  out = here_.force;
  out.resize(unknowns(), Vec3::Zero());
  for (std::size_t t = 0; t < twin_of_.size(); ++t) {
    const int a = twin_of_[t];
    const Vec3 tie = tie_force(t);
    out[a] += tie;
    out[twins_begin() + t] = -tie;
    stored_ += 0.5 * tie.dot(twin_[t] - x()[a]);
  }
  std::copy(here_.moment.begin(), here_.moment.end(), out.begin() + rotations_begin());
  if (keeps_volume()) volumes_->constrain_force(out);
  pull_.setZero();
  if (!held_.empty())
    for (std::size_t a = 0; a < nodes; ++a) {
      const Vec3 held = held_[a] * out[a];
      pull_ += held;
      out[a] -= held;
    }
  own_force_.assign(out.begin() + twins_begin(), out.end());
}

void ImmersedStructure::update_tangent() {
  if (!abrupt_.empty()) probed_stiffness_ = abrupt_stiffness();
  term_forces(system_->state, here_);
}

void ImmersedStructure::tangent_product(const Points& direction, Points& out) const {
  const std::size_t nodes = system_->nodes(), turns = system_->rotational_nodes();
  out.assign(unknowns(), Vec3::Zero());
  Points free(nodes), spin(turns);
  double length = 0, angle = 0;
  for (std::size_t a = 0; a < nodes; ++a) {
    free[a] = free_part(static_cast<int>(a), direction[a]);
  }
  if (keeps_volume()) volumes_->constrain_velocity(free);
  for (const Vec3& each : free) length = std::max(length, each.norm());
  for (std::size_t r = 0; r < turns; ++r) {
    const Vec3& w = direction[rotations_begin() + r];
    spin[r] = w - system_->held_axes(static_cast<int>(r)) * w;
    angle = std::max(angle, spin[r].norm());
  }
  const double size = std::max(length / shortest_, angle);
  if (size > 0) {
    const double step = difference_share / size;
    near_ = system_->state;
    for (std::size_t a = 0; a < nodes; ++a) near_.x[a] += step * free[a];
    for (std::size_t r = 0; r < turns; ++r)
      near_.rotation[r] = (turn_by(step * spin[r]) * near_.rotation[r]).normalized();
    term_forces(near_, near_forces_);
    for (std::size_t a = 0; a < nodes; ++a) out[a] = (here_.force[a] - near_forces_.force[a]) / step;
    for (std::size_t r = 0; r < turns; ++r) {
      const Vec3 moment = (here_.moment[r] - near_forces_.moment[r]) / step;
      out[rotations_begin() + r] = moment - system_->held_axes(static_cast<int>(r)) * moment;
    }
  }
  const double square = settings_.tie_rate_per_s * settings_.tie_rate_per_s;
  for (std::size_t t = 0; t < twin_of_.size(); ++t) {
    const int a = twin_of_[t];
    const Vec3 pull = settings_.excess_mass_g[a] * square * (free[a] - direction[twins_begin() + t]);
    out[a] += pull;
    out[twins_begin() + t] -= pull;
  }
  if (keeps_volume()) volumes_->constrain_force(out);
  for (std::size_t a = 0; a < nodes; ++a) out[a] = free_part(static_cast<int>(a), out[a]);
}

void ImmersedStructure::move(Points& velocity, double dt_s) {
  Configuration& state = system_->state;
  VALSALVA_ASSERT(velocity.size() >= state.x.size());
  velocity.resize(unknowns(), Vec3::Zero());
  for (std::size_t a = 0; a < state.x.size(); ++a) {
    if (!held_.empty()) velocity[a] += held_[a] * (state.v[a] - velocity[a]);
    if (!(velocity[a].norm() < fastest_mm_per_s))
      throw NumericalFailure(
          "coupling: {} at ({:.3g}, {:.3g}, {:.3g}) mm moves at {:.4g} mm/s, faster than {} mm/s",
          system_->describe(static_cast<int>(a)), state.x[a].x(), state.x[a].y(), state.x[a].z(),
          velocity[a].norm(), fastest_mm_per_s);
    state.v[a] = velocity[a];
  }
  if (keeps_volume()) volumes_->constrain_velocity(state.v, dt_s);
  if (settings_.guard) settings_.guard(*system_, dt_s);
  for (std::size_t a = 0; a < state.x.size(); ++a) {
    velocity[a] = state.v[a];
    state.x[a] += dt_s * velocity[a];
  }
  for (std::size_t t = 0; t < twin_of_.size(); ++t) {
    twin_velocity_[t] += dt_s / settings_.excess_mass_g[twin_of_[t]] * own_force_[t];
    twin_[t] += dt_s * twin_velocity_[t];
    velocity[twins_begin() + t] = twin_velocity_[t];
  }
  for (std::size_t r = 0; r < system_->rotational_nodes(); ++r) {
    Vec3& w = state.angular_velocity[r];
    const Mat3 free = Mat3::Identity() - system_->held_axes(static_cast<int>(r));
    const Vec3 kick = dt_s / system_->inertia(static_cast<int>(r)) * own_force_[twin_of_.size() + r];
    const double decay = dt_s * settings_.rotation_damping_per_s;
    w += free * ((kick - decay * w) / (1 + decay));
    state.rotation[r] = (turn_by(dt_s * w) * state.rotation[r]).normalized();
    velocity[rotations_begin() + r] = w;
  }
  state.time_s += dt_s;
  moved();
}

EdgeStretch ImmersedStructure::edge_stretch(const Points& since) const {
  EdgeStretch found{0, 0};
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto [a, b] = edges_[i];
    const double now = (x()[a] - x()[b]).norm(), then = (since[a] - since[b]).norm();
    found.largest = std::max(found.largest, now / rest_length_[i]);
    found.change = std::max(found.change, std::abs(now - then) / then);
  }
  return found;
}

Vec3 ImmersedStructure::excess_momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t t = 0; t < twin_of_.size(); ++t)
    sum += settings_.excess_mass_g[twin_of_[t]] * twin_velocity_[t];
  return sum;
}

double ImmersedStructure::largest_slip() const {
  double largest = 0;
  for (std::size_t t = 0; t < twin_of_.size(); ++t)
    largest = std::max(largest, (twin_[t] - x()[twin_of_[t]]).norm());
  return largest;
}

std::map<std::string, state::Array> ImmersedStructure::save() const {
  std::map<std::string, state::Array> out;
  const auto put = [&](const std::string& name, state::Array array) {
    out[prefix + name] = std::move(array);
  };
  const Configuration& now = system_->state;
  put("time_s", state::Array::scalar(now.time_s));
  put("velocity", state::Array::of(now.v));
  if (!abrupt_.empty()) put("probed_stiffness", state::Array::scalar(probed_stiffness_));
  if (!twin_of_.empty()) {
    put("twin", state::Array::of(twin_));
    put("twin_velocity", state::Array::of(twin_velocity_));
  }
  if (!now.rotation.empty()) {
    std::vector<double> rotation;
    for (const Eigen::Quaterniond& q : now.rotation)
      rotation.insert(rotation.end(), {q.w(), q.x(), q.y(), q.z()});
    put("rotation", state::Array::of(std::move(rotation)));
    put("angular_velocity", state::Array::of(now.angular_velocity));
  }
  for (std::size_t i = 0; i < terms_.size(); ++i)
    for (auto& [name, values] : terms_[i]->save())
      put("term" + std::to_string(i) + "/" + name, state::Array::of(values));
  return out;
}

void ImmersedStructure::load(const state::State& state) {
  const auto points = [&](const std::string& name, std::size_t size) {
    Points read = state.array(prefix + name).points(prefix + name);
    if (read.size() != size)
      throw InputError("{}: {}{} has {} entries, the body has {}", state.source, prefix, name, read.size(),
                       size);
    return read;
  };
  Configuration& now = system_->state;
  now.time_s = state.array(prefix + std::string("time_s")).number("coupling/body/time_s");
  now.v = points("velocity", now.x.size());
  if (!abrupt_.empty())
    probed_stiffness_ =
        state.array(prefix + std::string("probed_stiffness")).number("coupling/body/probed_stiffness");
  if (!twin_of_.empty()) {
    twin_ = points("twin", twin_of_.size());
    twin_velocity_ = points("twin_velocity", twin_of_.size());
  }
  if (!now.rotation.empty()) {
    const std::string name = prefix + std::string("rotation");
    const std::vector<double>& values = state.array(name).doubles(name);
    if (values.size() != 4 * now.rotation.size())
      throw InputError("{}: {} has {} values, expected {}", state.source, name, values.size(),
                       4 * now.rotation.size());
    for (std::size_t r = 0; r < now.rotation.size(); ++r)
      now.rotation[r] =
          Eigen::Quaterniond(values[4 * r], values[4 * r + 1], values[4 * r + 2], values[4 * r + 3]);
    now.angular_velocity = points("angular_velocity", now.rotation.size());
  }
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    structure::Snapshot snapshot;
    for (const auto& [name, expected] : terms_[i]->save()) {
      const std::string full = prefix + ("term" + std::to_string(i)) + "/" + name;
      snapshot[name] = state.array(full).doubles(full);
    }
    if (!snapshot.empty()) terms_[i]->restore(snapshot);
  }
}

}  // namespace valsalva::coupling
