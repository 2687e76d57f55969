#include "solve/implicit.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::solve {

using structure::BlockMatrix;
using structure::Configuration;

ImplicitIntegrator::ImplicitIntegrator(structure::System& system,
                                       std::vector<std::shared_ptr<structure::ForceTerm>> terms,
                                       const Supports& supports, const ImplicitSettings& settings)
    : settings_(settings),
      equations_(system, std::move(terms), supports),
      matrix_(equations_.matrix()),
      solver_(settings.linear) {
  const double r = settings_.spectral_radius;
  if (!(settings_.step_s > 0) || !(r >= 0 && r <= 1) || !(settings_.damping_per_s >= 0))
    throw InputError(
        "implicit dynamics: step {} s, spectral radius {}, damping {} 1/s; expected positive, 0 to 1, not "
        "negative",
        settings_.step_s, r, settings_.damping_per_s);
  am_ = (2 * r - 1) / (r + 1);
  af_ = r / (r + 1);
  g_ = 0.5 - am_ + af_;
  b_ = 0.25 * (1 - am_ + af_) * (1 - am_ + af_);
  const int nodes = static_cast<int>(system.nodes());
  mass_.resize(equations_.unknowns());
  for (int i = 0; i < equations_.unknowns(); ++i)
    mass_[i] = i / 3 < nodes ? system.mass(i / 3) : system.inertia(i / 3 - nodes);
}

Eigen::VectorXd ImplicitIntegrator::velocity() const {
  const Configuration& now = equations_.system().state;
  Eigen::VectorXd v(equations_.unknowns());
  const int nodes = static_cast<int>(now.v.size());
  for (int a = 0; a < nodes; ++a) v.segment<3>(3 * a) = now.v[a];
  for (std::size_t r = 0; r < now.angular_velocity.size(); ++r)
    v.segment<3>(3 * (nodes + static_cast<int>(r))) = now.angular_velocity[r];
  return equations_.local(std::move(v));
}

void ImplicitIntegrator::start() {
  double size = 0;
  force_ = equations_.forces(size, stored_);
  acceleration_ = (force_ - settings_.damping_per_s * mass_.cwiseProduct(velocity())).cwiseQuotient(mass_);
  for (int i = 0; i < equations_.unknowns(); ++i)
    if (equations_.fixed()[i]) acceleration_[i] = 0;
  started_ = true;
}

Eigen::VectorXd ImplicitIntegrator::increment_since(const Configuration& before) const {
  const Configuration& now = equations_.system().state;
  Eigen::VectorXd u(equations_.unknowns());
  const int nodes = static_cast<int>(now.x.size());
  for (int a = 0; a < nodes; ++a) u.segment<3>(3 * a) = now.x[a] - before.x[a];
  for (std::size_t r = 0; r < now.rotation.size(); ++r) {
    Eigen::Quaterniond turn = now.rotation[r] * before.rotation[r].conjugate();
    if (turn.w() < 0) turn.coeffs() *= -1;
    const Vec3 sine = turn.vec();
    const double half = std::atan2(sine.norm(), turn.w());
    u.segment<3>(3 * (nodes + static_cast<int>(r))) =
        half > 1e-12 ? Vec3(2 * half / sine.norm() * sine) : Vec3(2 * sine);
  }
  return equations_.local(std::move(u));
}

void ImplicitIntegrator::step() {
  if (!started_) start();
  Configuration& now = equations_.system().state;
  const double dt = settings_.step_s, damping = settings_.damping_per_s;
  const Attempt undo(equations_, now);
  const Configuration before = now;
  const Eigen::VectorXd v0 = velocity();
  const auto accelerations = [&]() -> Eigen::VectorXd {
    return (increment_since(before) - dt * v0) / (b_ * dt * dt) - (0.5 / b_ - 1) * acceleration_;
  };
  const auto set_velocity = [&](const Eigen::VectorXd& a1) -> Eigen::VectorXd {
    const Eigen::VectorXd v1 = v0 + dt * ((1 - g_) * acceleration_ + g_ * a1);
    const Eigen::VectorXd v = equations_.in_space(v1);
    const int nodes = static_cast<int>(now.v.size());
    for (int a = 0; a < nodes; ++a) now.v[a] = v.segment<3>(3 * a);
    for (std::size_t r = 0; r < now.angular_velocity.size(); ++r)
      now.angular_velocity[r] = v.segment<3>(3 * (nodes + static_cast<int>(r)));
    return v1;
  };
  Eigen::VectorXd force;
  const NewtonProblem problem{
      [&](double& size) -> Eigen::VectorXd {
        const Eigen::VectorXd a1 = accelerations(), v1 = set_velocity(a1);
        force = equations_.forces(size, stored_);
        const Eigen::VectorXd inertia =
            mass_.cwiseProduct((1 - am_) * a1 + am_ * acceleration_ + damping * ((1 - af_) * v1 + af_ * v0));
        size = (1 - af_) * size + equations_.norm_of_all(inertia);
        return (1 - af_) * force + af_ * force_ - inertia;
      },
      [&](BlockMatrix& k) {
        equations_.tangent(k);
        k.scale(1 - af_);
        const double factor = (1 - am_) / (b_ * dt * dt) + damping * (1 - af_) * g_ / (b_ * dt);
        for (int i = 0; i < k.slots(); ++i) k.add(i, i, factor * mass_[3 * i] * Mat3::Identity());
      }};
  try {
    for (const auto& term : equations_.terms()) term->begin_step(now, dt);
    now.time_s = before.time_s + dt;
    // Held nodes stay; the others start from constant velocity unless that reverses an element.
    Eigen::VectorXd guess = dt * v0;
    for (int i = 0; i < equations_.unknowns(); ++i)
      if (equations_.fixed()[i]) guess[i] = 0;
    equations_.move(equations_.allowed(guess) * guess);
    try {
      double size = 0, stored = 0;
      equations_.forces(size, stored);
    } catch (const NumericalFailure&) {
      now.x = before.x;
      now.rotation = before.rotation;
    }
    iterations_ += newton(equations_, problem, matrix_, solver_, settings_.newton).iterations;
  } catch (const NumericalFailure& failure) {
    undo.undo(equations_);
    throw NumericalFailure("implicit dynamics: the step of {} s from {:.6g} s failed: {}; reduce the step",
                           dt, before.time_s, failure.what());
  }
  const Eigen::VectorXd a1 = accelerations();
  set_velocity(a1);
  acceleration_ = a1;
  force_ = force;
  ++steps_;
}

double ImplicitIntegrator::kinetic_energy() const {
  const Eigen::VectorXd v = velocity();
  return 0.5 * v.dot(mass_.cwiseProduct(v));
}

Vec3 ImplicitIntegrator::momentum() const {
  const structure::System& system = equations_.system();
  Vec3 total = Vec3::Zero();
  for (std::size_t a = 0; a < system.nodes(); ++a)
    total += system.mass(static_cast<int>(a)) * system.state.v[a];
  return total;
}

Vec3 ImplicitIntegrator::angular_momentum() const {
  const structure::System& system = equations_.system();
  Vec3 total = Vec3::Zero();
  for (std::size_t a = 0; a < system.nodes(); ++a)
    total += system.mass(static_cast<int>(a)) * system.state.x[a].cross(system.state.v[a]);
  for (std::size_t r = 0; r < system.rotational_nodes(); ++r)
    total += system.inertia(static_cast<int>(r)) * system.state.angular_velocity[r];
  return total;
}

structure::Snapshot ImplicitIntegrator::save() const {
  const Configuration& now = equations_.system().state;
  structure::Snapshot s;
  const auto put = [&](const char* name, const Points& points) {
    std::vector<double>& values = s[name];
    for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
  };
  put("x", now.x);
  put("v", now.v);
  put("angular_velocity", now.angular_velocity);
  std::vector<double>& rotation = s["rotation"];
  for (const Eigen::Quaterniond& q : now.rotation)
    rotation.insert(rotation.end(), {q.w(), q.x(), q.y(), q.z()});
  s["acceleration"] = {acceleration_.begin(), acceleration_.end()};
  s["force"] = {force_.begin(), force_.end()};
  s["clock"] = {now.time_s, static_cast<double>(steps_), started_ ? 1.0 : 0.0, stored_};
  for (const auto& term : equations_.terms())
    for (const auto& [name, values] : term->save()) s["term/" + term->name() + "/" + name] = values;
  return s;
}

void ImplicitIntegrator::restore(const structure::Snapshot& s) {
  Configuration& now = equations_.system().state;
  const auto get = [&](const std::string& name, std::size_t size) -> std::vector<double> {
    const auto it = s.find(name);
    const std::vector<double> values = it == s.end() ? std::vector<double>{} : it->second;
    if (values.size() != size)
      throw InputError(
          "restart of the implicit dynamics: entry '{}' has {} values; expected {}: the state belongs to "
          "another scene",
          name, values.size(), size);
    return values;
  };
  const auto points = [&](const std::string& name, Points& out) {
    const std::vector<double> values = get(name, 3 * out.size());
    for (std::size_t a = 0; a < out.size(); ++a)
      out[a] = Vec3(values[3 * a], values[3 * a + 1], values[3 * a + 2]);
  };
  const std::vector<double> clock = get("clock", 4);
  points("x", now.x);
  points("v", now.v);
  points("angular_velocity", now.angular_velocity);
  const std::vector<double> q = get("rotation", 4 * now.rotation.size());
  for (std::size_t r = 0; r < now.rotation.size(); ++r)
    now.rotation[r] = Eigen::Quaterniond(q[4 * r], q[4 * r + 1], q[4 * r + 2], q[4 * r + 3]);
  now.time_s = clock[0];
  steps_ = static_cast<long>(clock[1]);
  started_ = clock[2] != 0;
  stored_ = clock[3];
  if (started_) {
    const std::vector<double> a = get("acceleration", mass_.size()), f = get("force", mass_.size());
    acceleration_ = Eigen::Map<const Eigen::VectorXd>(a.data(), mass_.size());
    force_ = Eigen::Map<const Eigen::VectorXd>(f.data(), mass_.size());
  }
  for (const auto& term : equations_.terms()) {
    const std::string prefix = "term/" + term->name() + "/";
    structure::Snapshot own;
    for (const auto& [name, values] : s)
      if (name.rfind(prefix, 0) == 0) own[name.substr(prefix.size())] = values;
    term->restore(own);
  }
}

}  // namespace valsalva::solve
