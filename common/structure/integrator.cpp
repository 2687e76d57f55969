#include "structure/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

std::vector<double> flat(const Points& points) {
  std::vector<double> values;
  values.reserve(3 * points.size());
  for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return values;
}

// What is empty is not stored.
const std::vector<double>& entry(const Snapshot& snapshot, const std::string& name, std::size_t size) {
  static const std::vector<double> empty;
  const auto it = snapshot.find(name);
  const std::vector<double>& values = it == snapshot.end() ? empty : it->second;
  if (values.size() != size)
    throw InputError(
        "restart of the structure: entry '{}' has {} values; expected {}: the state belongs to another "
        "scene; start the stage anew",
        name, values.size(), size);
  return values;
}

void unflatten(const std::vector<double>& values, Points& points) {
  for (std::size_t a = 0; a < points.size(); ++a)
    points[a] = Vec3(values[3 * a], values[3 * a + 1], values[3 * a + 2]);
}

Eigen::Quaterniond exponential(const Vec3& turn) {
  const double angle = turn.norm();
  const double half = 0.5 * angle;
  const double scale = angle > 1e-8 ? std::sin(half) / angle : 0.5;
  return {std::cos(half), scale * turn.x(), scale * turn.y(), scale * turn.z()};
}

}  // namespace

Integrator::Integrator(System& system, std::vector<std::shared_ptr<ForceTerm>> terms,
                       const IntegratorSettings& settings)
    : system_(system),
      terms_(std::move(terms)),
      settings_(settings),
      mass_(system.masses()),
      inertia_(system.inertias()),
      carried_(system.nodes(), 0),
      dt_(settings.step_s),
      stored_of_(terms_.size(), 0.0),
      interval_(std::isfinite(settings.growth_limit) ? 1 : settings.scaling_interval) {
  if (!(settings_.growth_limit > 1))
    throw InputError("integrator: growth limit {}; expected above 1", settings_.growth_limit);
  if (!(settings_.step_s > 0) || !(settings_.safety > 0) || settings_.safety > 1 ||
      settings_.scaling_interval < 1 || !(settings_.damping_per_s >= 0))
    throw InputError(
        "integrator: step {} s, safety {}, scaling interval {}, damping {} 1/s; expected positive, in "
        "(0, 1], at least 1, not negative",
        settings_.step_s, settings_.safety, settings_.scaling_interval, settings_.damping_per_s);
}

void Integrator::add_rigid(std::shared_ptr<RigidBody> body) {
  for (int a = body->body().begin(); a < body->body().end(); ++a) carried_[a] = 1;
  rigid_.push_back(std::move(body));
}

double Integrator::prepare(double largest_s) {
  for (const auto& term : terms_) term->begin_step(system_.state, dt_);
  bound_stiffness();
  if (settings_.adaptive) choose_step(largest_s);
  return dt_;
}

void Integrator::advance() {
  evaluate_forces();
  if (steps_ == 0) {
    energies_.stored_at_start = energies_.stored;
    energies_.kinetic_at_start = kinetic_energy();
  }
  move();
  energies_.kinetic = kinetic_energy();
  system_.state.time_s += dt_;
  last_dt_ = dt_;
  ++steps_;
}

void Integrator::move() {
  if (!settings_.adaptive) {
    move_nodes();
    turn_nodes();
    return;
  }
  const Configuration before = system_.state;
  const Energies energies = energies_;
  std::vector<RigidBody> rigid;
  for (const auto& body : rigid_) rigid.push_back(*body);
  constexpr int most = 50;
  constexpr double collapse = 1e-9;
  for (int repeats = 0;; ++repeats) {
    move_nodes();
    turn_nodes();
    double share = 1;
    for (const auto& term : terms_) share = std::min(share, term->allowed_motion(before, system_.state.x));
    if (share >= 1) return;
    if (!(share > 0) || repeats == most || dt_ * share < collapse * first_dt_)
      throw NumericalFailure(
          "structure: no step is small enough to keep bodies apart at {:.6g} s (share {:.3g} of {:.3g} s); "
          "the "
          "load or the speed is too large for the stiffness of the contact",
          before.time_s, share, dt_);
    dt_ *= 0.95 * share;  // the kick changes with the step, and with it the velocities
    system_.state = before;
    energies_ = energies;
    for (std::size_t b = 0; b < rigid_.size(); ++b) *rigid_[b] = rigid[b];
  }
}

void Integrator::evaluate_forces() {
  forces_.reset(system_.nodes(), system_.rotational_nodes());
  energies_.stored = 0;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    stored_of_[i] = terms_[i]->add_forces(system_.state, forces_);
    if (!std::isfinite(stored_of_[i]))
      throw NumericalFailure(
          "structure: the energy of '{}' is not finite at {} s; reduce the step or the load rate",
          terms_[i]->name(), system_.state.time_s);
    energies_.stored += stored_of_[i];
  }
}

void Integrator::bound_stiffness() {
  const bool all = steps_ == next_bound_;
  const bool any =
      std::any_of(terms_.begin(), terms_.end(), [](auto& t) { return t->stiffness_is_abrupt(); });
  if (!all && !any) return;
  if (all) {
    smooth_.reset(system_.nodes(), system_.rotational_nodes());
    for (const auto& term : terms_)
      if (!term->stiffness_is_abrupt()) term->add_stiffness_bound(system_.state, smooth_);
    const double grown = steps_ > 0 && std::isfinite(settings_.growth_limit) ? outgrown() : 1;
    if (grown > settings_.growth_limit)
      interval_ = std::max(1, interval_ / 2);
    else if (grown <= std::sqrt(settings_.growth_limit))
      interval_ = std::min(settings_.scaling_interval, 2 * interval_);
    next_bound_ = steps_ + interval_;
  }
  bound_ = smooth_;
  for (const auto& term : terms_)
    if (term->stiffness_is_abrupt()) term->add_stiffness_bound(system_.state, bound_);
  if (!settings_.adaptive) scale_masses();
}

/// The largest smooth bound over the one for which its mass and the step were chosen.
double Integrator::outgrown() const {
  const double reach = dt_ / (2 * settings_.safety);
  double most = 0;
  for (std::size_t a = 0; a < mass_.size(); ++a)
    if (!system_.held(static_cast<int>(a)))
      most = std::max(most, reach * reach * smooth_.translation[a] / mass_[a]);
  for (std::size_t r = 0; r < inertia_.size(); ++r)
    if (!system_.held(system_.node_of_rotation(static_cast<int>(r))))
      most = std::max(most, reach * reach * smooth_.rotation[r] / inertia_[r]);
  return most;
}

void Integrator::choose_step(double largest_s) {
  constexpr double growth = 1.1, collapse = 1e-5;
  double most = 0;
  std::string where;
  for (std::size_t a = 0; a < mass_.size(); ++a)
    if (!system_.held(static_cast<int>(a)) && bound_.translation[a] > most * mass_[a]) {
      most = bound_.translation[a] / mass_[a];
      where = system_.describe(static_cast<int>(a));
    }
  for (std::size_t r = 0; r < inertia_.size(); ++r)
    if (!system_.held(system_.node_of_rotation(static_cast<int>(r))) &&
        bound_.rotation[r] > most * inertia_[r]) {
      most = bound_.rotation[r] / inertia_[r];
      where = "the rotation of " + system_.describe(system_.node_of_rotation(static_cast<int>(r)));
    }
  for (const auto& body : rigid_)
    if (const double ratio = body->largest_ratio(bound_); ratio > most) {
      most = ratio;
      where = "rigid body " + body->name();
    }
  dt_ = settings_.step_s;
  if (most > 0) dt_ = std::min(dt_, 2 * settings_.safety / std::sqrt(most));
  if (first_dt_ == 0) first_dt_ = dt_;
  if (!(dt_ > collapse * first_dt_))
    throw NumericalFailure(
        "structure: the stable step has fallen from {:.3g} to {:.3g} s at {:.6g} s because of {}: too much "
        "load "
        "or too fast an impact for its stiffness",
        first_dt_, dt_, system_.state.time_s, where);
  if (last_dt_ > 0) dt_ = std::min(dt_, growth * last_dt_);
  dt_ = std::min(dt_, largest_s);
}

void Integrator::scale_masses() {
  const double reach = settings_.step_s / (2 * settings_.safety);
  const double before = kinetic_energy();
  for (std::size_t a = 0; a < mass_.size(); ++a) {
    const double needed = reach * reach * bound_.translation[a];
    const double own = system_.mass(static_cast<int>(a));
    if (!settings_.mass_scaling && needed > own)
      throw InputError(
          "structure: a step of {} s is not stable for {}; expected at most {} s, or mass scaling",
          settings_.step_s, system_.describe(static_cast<int>(a)),
          settings_.step_s * std::sqrt(own / needed));
    mass_[a] = std::max(own, needed);
  }
  for (std::size_t r = 0; r < inertia_.size(); ++r) {
    const double needed = reach * reach * bound_.rotation[r];
    const double own = system_.inertia(static_cast<int>(r));
    if (!settings_.mass_scaling && needed > own)
      throw InputError(
          "structure: a step of {} s is not stable for the rotation of {}; expected at most {} s, or "
          "mass scaling",
          settings_.step_s, system_.describe(system_.node_of_rotation(static_cast<int>(r))),
          settings_.step_s * std::sqrt(own / needed));
    inertia_[r] = std::max(own, needed);
  }
  if (steps_ > 0) energies_.scaling_energy += kinetic_energy() - before;
}

void Integrator::move_nodes() {
  Configuration& now = system_.state;
  const double dt = dt_, kick = kick_s(), damping = 0.5 * settings_.damping_per_s * kick;
  if (!rigid_.empty()) {
    std::vector<double> extra(mass_.size());
    for (std::size_t a = 0; a < extra.size(); ++a) extra[a] = mass_[a] - system_.mass(static_cast<int>(a));
    for (const auto& body : rigid_) body->advance(system_, forces_, extra, kick, dt, settings_.damping_per_s);
  }
  for (std::size_t a = 0; a < mass_.size(); ++a) {
    const int node = static_cast<int>(a);
    if (system_.held(node)) {
      if (!carried_[a]) energies_.support_work -= dt * forces_.force[a].dot(now.v[a]);
    } else {
      const Vec3 before = now.v[a];
      now.v[a] = ((1 - damping) * before + kick / mass_[a] * forces_.force[a]) / (1 + damping);
      Vec3 mean = 0.5 * (before + now.v[a]);
      if (system_.partly_held(node)) {
        const Mat3 held = system_.held_directions(node);
        now.v[a] += held * (before - now.v[a]);
        mean -= held * mean;
        energies_.support_work -= dt * forces_.force[a].dot(held * before);
      }
      energies_.damping_work += 2 * damping * mass_[a] * mean.squaredNorm();
    }
    const double speed = now.v[a].norm();
    if (!(speed < settings_.speed_limit_mm_per_s))
      throw NumericalFailure(
          "structure: {} at ({:.3f}, {:.3f}, {:.3f}) mm moves at {:.3g} mm/s at {:.6g} s (alarm at "
          "{:.3g}); reduce the step or the load rate, or look at the contact there",
          system_.describe(node), now.x[a].x(), now.x[a].y(), now.x[a].z(), speed, now.time_s,
          settings_.speed_limit_mm_per_s);
    now.x[a] += dt * now.v[a];
  }
}

void Integrator::turn_nodes() {
  Configuration& now = system_.state;
  const double dt = dt_, kick = kick_s(), damping = 0.5 * settings_.damping_per_s * kick;
  for (std::size_t r = 0; r < inertia_.size(); ++r) {
    const int node = system_.node_of_rotation(static_cast<int>(r));
    if (system_.held(node)) {
      energies_.support_work -= dt * forces_.moment[r].dot(now.angular_velocity[r]);
    } else {
      const Vec3 before = now.angular_velocity[r];
      now.angular_velocity[r] =
          ((1 - damping) * before + kick / inertia_[r] * forces_.moment[r]) / (1 + damping);
      Vec3 mean = 0.5 * (before + now.angular_velocity[r]);
      if (system_.rotation_partly_held(static_cast<int>(r))) {
        const Mat3 held = system_.held_axes(static_cast<int>(r));
        now.angular_velocity[r] += held * (before - now.angular_velocity[r]);
        mean -= held * mean;
        energies_.support_work -= dt * forces_.moment[r].dot(held * before);
      }
      energies_.damping_work += 2 * damping * inertia_[r] * mean.squaredNorm();
    }
    const double turn = dt * now.angular_velocity[r].norm();
    if (!(turn < 1))
      throw NumericalFailure(
          "structure: {} turns by {:.3g} rad in one step at {:.6g} s (alarm at 1); reduce the step "
          "or the load rate",
          system_.describe(node), turn, now.time_s);
    now.rotation[r] = (exponential(dt * now.angular_velocity[r]) * now.rotation[r]).normalized();
  }
}

double Integrator::kick_s() const {
  return settings_.adaptive ? 0.5 * (last_dt_ + dt_) : dt_;
}

double Integrator::kinetic_energy() const {
  double twice = 0;
  for (const auto& body : rigid_) twice += 2 * body->kinetic_energy();
  for (std::size_t a = 0; a < mass_.size(); ++a) {
    const int node = static_cast<int>(a);
    if (system_.held(node)) continue;
    Vec3 v = system_.state.v[a];
    if (system_.partly_held(node)) v -= system_.held_directions(node) * v;
    twice += mass_[a] * v.squaredNorm();
  }
  for (std::size_t r = 0; r < inertia_.size(); ++r) {
    const int rotation = static_cast<int>(r);
    if (system_.held(system_.node_of_rotation(rotation))) continue;
    Vec3 w = system_.state.angular_velocity[r];
    if (system_.rotation_partly_held(rotation)) w -= system_.held_axes(rotation) * w;
    twice += inertia_[r] * w.squaredNorm();
  }
  return 0.5 * twice;
}

double Integrator::mass_ratio() const {
  double now = 0, physical = 0;
  for (std::size_t a = 0; a < mass_.size(); ++a) {
    now += mass_[a];
    physical += system_.mass(static_cast<int>(a));
  }
  return now / physical;
}

Vec3 Integrator::momentum() const {
  Vec3 total = Vec3::Zero();
  for (std::size_t a = 0; a < mass_.size(); ++a)
    if (!carried_[a]) total += mass_[a] * system_.state.v[a];
  for (const auto& body : rigid_) total += body->momentum();
  return total;
}

Vec3 Integrator::angular_momentum() const {
  const Configuration& now = system_.state;
  Vec3 total = Vec3::Zero();
  for (std::size_t a = 0; a < mass_.size(); ++a)
    if (!carried_[a]) total += mass_[a] * now.x[a].cross(now.v[a]);
  for (const auto& body : rigid_) total += body->angular_momentum();
  for (std::size_t r = 0; r < inertia_.size(); ++r) total += inertia_[r] * now.angular_velocity[r];
  return total;
}

Snapshot Integrator::save() const {
  const Configuration& now = system_.state;
  Snapshot s;
  s["x"] = flat(now.x);
  s["v"] = flat(now.v);
  s["angular_velocity"] = flat(now.angular_velocity);
  for (const Eigen::Quaterniond& q : now.rotation)
    s["rotation"].insert(s["rotation"].end(), {q.w(), q.x(), q.y(), q.z()});
  s["rotation"];  // present even when there are no rotations
  s["mass"] = mass_;
  s["inertia"] = inertia_;
  s["smooth_bound"] = smooth_.translation;
  s["smooth_bound_rotation"] = smooth_.rotation;
  s["clock"] = {now.time_s, static_cast<double>(steps_), settings_.damping_per_s};
  s["energies"] = {energies_.kinetic,          energies_.stored,       energies_.stored_at_start,
                   energies_.kinetic_at_start, energies_.damping_work, energies_.support_work,
                   energies_.scaling_energy};
  if (std::isfinite(settings_.growth_limit))
    s["bounds"] = {static_cast<double>(interval_), static_cast<double>(next_bound_)};
  if (settings_.adaptive) s["steps"] = {dt_, last_dt_, first_dt_};
  for (const auto& body : rigid_) s["rigid/" + body->name()] = body->save();
  std::vector<double>& held = s["held"];
  for (std::size_t a = 0; a < mass_.size(); ++a) held.push_back(system_.held(static_cast<int>(a)) ? 1 : 0);
  for (const auto& term : terms_)
    for (const auto& [name, values] : term->save()) s["term/" + term->name() + "/" + name] = values;
  return s;
}

void Integrator::restore(const Snapshot& s) {
  Configuration& now = system_.state;
  const std::size_t nodes = system_.nodes(), turning = system_.rotational_nodes();
  unflatten(entry(s, "x", 3 * nodes), now.x);
  unflatten(entry(s, "v", 3 * nodes), now.v);
  unflatten(entry(s, "angular_velocity", 3 * turning), now.angular_velocity);
  const std::vector<double>& q = entry(s, "rotation", 4 * turning);
  for (std::size_t r = 0; r < turning; ++r)
    now.rotation[r] = Eigen::Quaterniond(q[4 * r], q[4 * r + 1], q[4 * r + 2], q[4 * r + 3]);
  mass_ = entry(s, "mass", nodes);
  inertia_ = entry(s, "inertia", turning);
  const bool begun = s.count("smooth_bound") && !s.at("smooth_bound").empty();  // not before the first step
  smooth_.translation = entry(s, "smooth_bound", begun ? nodes : 0);
  smooth_.rotation = entry(s, "smooth_bound_rotation", begun ? turning : 0);
  const std::vector<double>& clock = entry(s, "clock", 3);
  now.time_s = clock[0];
  steps_ = static_cast<long>(clock[1]);
  settings_.damping_per_s = clock[2];
  if (std::isfinite(settings_.growth_limit)) {
    const std::vector<double>& bounds = entry(s, "bounds", 2);
    interval_ = static_cast<int>(bounds[0]);
    next_bound_ = static_cast<long>(bounds[1]);
  } else {
    next_bound_ = (steps_ + interval_ - 1) / interval_ * interval_;
  }
  if (settings_.adaptive) {
    const std::vector<double>& steps = entry(s, "steps", 3);
    dt_ = steps[0];
    last_dt_ = steps[1];
    first_dt_ = steps[2];
  }
  for (const auto& body : rigid_) body->restore(entry(s, "rigid/" + body->name(), 14));
  const std::vector<double>& e = entry(s, "energies", 7);
  energies_ = {e[0], e[1], e[2], e[3], e[4], e[5], e[6]};
  const std::vector<double>& held = entry(s, "held", nodes);
  for (std::size_t a = 0; a < nodes; ++a) {
    if (held[a] != 0)
      system_.hold(static_cast<int>(a));
    else
      system_.release(static_cast<int>(a));
  }
  for (const auto& term : terms_) {
    const std::string prefix = "term/" + term->name() + "/";
    Snapshot own;
    for (const auto& [name, values] : s)
      if (name.rfind(prefix, 0) == 0) own[name.substr(prefix.size())] = values;
    term->restore(own);
  }
}

}  // namespace valsalva::structure
