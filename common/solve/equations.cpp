#include "solve/equations.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::solve {

using structure::BlockMatrix;
using structure::Configuration;

void Supports::fix(int node) {
  for (int c = 0; c < 3; ++c) fix(node, c);
}

void Supports::fix(int node, int component) {
  entries_.push_back({node, component, false, {}});
}

void Supports::fix_rotation(int rotation) {
  for (int c = 0; c < 3; ++c) fix_rotation(rotation, c);
}

void Supports::fix_rotation(int rotation, int component) {
  entries_.push_back({rotation, component, true, {}});
}

void Supports::move(int node, int component, Motion displacement) {
  entries_.push_back({node, component, false, std::move(displacement)});
}

void Supports::turn(int rotation, Turning rotated) {
  fix_rotation(rotation);
  turned_.push_back({rotation, std::move(rotated)});
}

Equations::Equations(structure::System& system, std::vector<std::shared_ptr<structure::ForceTerm>> terms,
                     const Supports& supports)
    : system_(system), terms_(std::move(terms)) {
  const int nodes = static_cast<int>(system.nodes()), rotations = static_cast<int>(system.rotational_nodes());
  fixed_.assign(3 * (nodes + rotations), 0);
  for (int a = 0; a < nodes; ++a) {
    if (!system.held(a)) continue;
    for (int c = 0; c < 3; ++c) {
      fixed_[3 * a + c] = 1;
      if (const int r = system.rotation_of(a); r >= 0) fixed_[3 * (nodes + r) + c] = 1;
    }
  }
  for (int a = 0; a < nodes; ++a)
    if (!system.held(a) && system.partly_held(a)) hold_along(a, system.held_directions(a));
  for (int r = 0; r < rotations; ++r)
    if (!system.held(system.node_of_rotation(r)) && system.rotation_partly_held(r))
      hold_along(nodes + r, system.held_axes(r));
  for (const Supports::Entry& entry : supports.entries_) {
    const int count = entry.rotation ? rotations : nodes;
    if (entry.index < 0 || entry.index >= count || entry.component < 0 || entry.component > 2)
      throw InputError("supports: {} {}, component {}; expected below {}, and 0 to 2",
                       entry.rotation ? "rotation" : "node", entry.index, entry.component, count);
    const int unknown = 3 * (entry.rotation ? nodes + entry.index : entry.index) + entry.component;
    if (frames_.count(unknown / 3))
      throw InputError("supports: {} is held along a skew direction; a component of it cannot be held too",
                       worst(Eigen::VectorXd::Unit(static_cast<Eigen::Index>(fixed_.size()), unknown)));
    fixed_[unknown] = 1;
    if (entry.motion)
      prescribed_.push_back({unknown, system.state.x[entry.index][entry.component], entry.motion});
  }
  for (const Supports::Turned& t : supports.turned_)
    turned_.push_back({t.rotation, system.state.rotation[t.rotation], t.turning});
  if (!system.state.x.empty()) {
    Vec3 low = system.state.x[0], high = low;
    for (const Vec3& x : system.state.x) low = low.cwiseMin(x), high = high.cwiseMax(x);
    length_ = std::max((high - low).norm(), 1e-9);
  }
}

void Equations::hold_along(int slot, const Mat3& projector) {
  const Mat3 off = projector - Mat3(projector.diagonal().asDiagonal());
  Vec3 held = projector.diagonal();
  if (off.cwiseAbs().maxCoeff() > 1e-12) {
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(projector);
    frames_[slot] = axes.eigenvectors();
    held = axes.eigenvalues();
  }
  for (int c = 0; c < 3; ++c)
    if (held[c] > 0.5) fixed_[3 * slot + c] = 1;
}

Eigen::VectorXd Equations::local(Eigen::VectorXd v) const {
  for (const auto& [slot, frame] : frames_)
    v.segment<3>(3 * slot) = (frame.transpose() * v.segment<3>(3 * slot)).eval();
  return v;
}

Eigen::VectorXd Equations::in_space(Eigen::VectorXd v) const {
  for (const auto& [slot, frame] : frames_) v.segment<3>(3 * slot) = (frame * v.segment<3>(3 * slot)).eval();
  return v;
}

int Equations::free_unknowns() const {
  return static_cast<int>(std::count(fixed_.begin(), fixed_.end(), 0));
}

Eigen::VectorXd Equations::forces(double& size, double& stored) const {
  Eigen::VectorXd total = Eigen::VectorXd::Zero(unknowns());
  const int nodes = static_cast<int>(system_.nodes());
  size = stored = 0;
  structure::Forces out;
  Eigen::VectorXd own(unknowns());
  for (const auto& term : terms_) {
    out.reset(system_.nodes(), system_.rotational_nodes());
    const double energy = term->add_forces(system_.state, out);
    for (int a = 0; a < nodes; ++a) own.segment<3>(3 * a) = out.force[a];
    for (std::size_t r = 0; r < out.moment.size(); ++r)
      own.segment<3>(3 * (nodes + static_cast<int>(r))) = out.moment[r];
    if (!std::isfinite(energy) || !own.allFinite())
      throw NumericalFailure("forces of '{}' are not finite", term->name());
    stored += energy;
    size += norm_of_all(own);
    total += own;
  }
  return local(std::move(total));
}

void Equations::tangent(BlockMatrix& k) const {
  k.set_zero();
  for (int i = 0; i < k.slots(); ++i) k.add(i, i, Mat3::Zero());  // every row has its diagonal
  for (const auto& term : terms_) term->add_tangent(system_.state, k);
  k.turn(frames_);
}

void Equations::move(const Eigen::VectorXd& unknowns) {
  const Eigen::VectorXd increment = in_space(unknowns);
  Configuration& now = system_.state;
  const int nodes = static_cast<int>(now.x.size());
  for (int a = 0; a < nodes; ++a) now.x[a] += increment.segment<3>(3 * a);
  for (std::size_t r = 0; r < now.rotation.size(); ++r) {
    const Vec3 spin = increment.segment<3>(3 * (nodes + static_cast<int>(r)));
    const double angle = spin.norm();
    if (angle == 0) continue;
    now.rotation[r] = (Eigen::AngleAxisd(angle, spin / angle) * now.rotation[r]).normalized();
  }
}

double Equations::allowed(const Eigen::VectorXd& increment) {
  const Configuration before = system_.state;
  move(increment);
  double share = 1;
  for (const auto& term : terms_) share = std::min(share, term->allowed_motion(before, system_.state.x));
  system_.state = before;
  return share;
}

Eigen::VectorXd Equations::missing(double time_s) const {
  Eigen::VectorXd gap = Eigen::VectorXd::Zero(unknowns());
  for (const Prescribed& p : prescribed_)
    gap[p.unknown] = p.start + p.motion(time_s) - system_.state.x[p.unknown / 3][p.unknown % 3];
  for (const Turned& t : turned_) {
    const Eigen::AngleAxisd spin(Eigen::Quaterniond(t.turning(time_s)) * t.start *
                                 system_.state.rotation[t.rotation].conjugate());
    const double angle = spin.angle() > M_PI ? spin.angle() - 2 * M_PI : spin.angle();
    gap.segment<3>(3 * (static_cast<int>(system_.nodes()) + t.rotation)) = angle * spin.axis();
  }
  return gap;
}

double Equations::norm(const Eigen::VectorXd& r) const {
  double square = 0;
  const int translations = 3 * static_cast<int>(system_.nodes());
  for (int i = 0; i < r.size(); ++i) {
    if (fixed_[i]) continue;
    const double value = i < translations ? r[i] : r[i] / length_;
    square += value * value;
  }
  return std::sqrt(square);
}

double Equations::norm_of_all(const Eigen::VectorXd& r) const {
  const Eigen::Index translations = 3 * static_cast<Eigen::Index>(system_.nodes());
  return std::sqrt(r.head(translations).squaredNorm() +
                   r.tail(r.size() - translations).squaredNorm() / (length_ * length_));
}

std::string Equations::worst(const Eigen::VectorXd& r) const {
  int at = 0;
  double largest = -1;
  for (int i = 0; i < r.size(); ++i)
    if (!fixed_[i] && std::abs(r[i]) > largest) largest = std::abs(r[i]), at = i;
  const int slot = at / 3, nodes = static_cast<int>(system_.nodes());
  return slot < nodes ? system_.describe(slot)
                      : "the rotation of " + system_.describe(system_.node_of_rotation(slot - nodes));
}

Attempt::Attempt(const Equations& equations, const Configuration& state) : state_(state) {
  for (const auto& term : equations.terms()) terms_.push_back(term->save());
}

void Attempt::undo(Equations& equations) const {
  equations.system().state = state_;
  for (std::size_t i = 0; i < terms_.size(); ++i) equations.terms()[i]->restore(terms_[i]);
}

namespace {

struct Trial {
  bool sound = false;
  Eigen::VectorXd residual;
  double size = 0, norm = 0, along = 0;
};

// What round-off leaves of the forces: 500 of its units of those that would move every node by the length of
// the scene.
double force_round_off(const Equations& equations, const BlockMatrix& k) {
  Eigen::VectorXd largest(3 * k.slots());
  for (int i = 0; i < k.slots(); ++i) {
    const BlockMatrix::Row& row = k.row(i);
    const auto own = std::lower_bound(row.columns.begin(), row.columns.end(), i) - row.columns.begin();
    largest.segment<3>(3 * i) = (i < k.nodes() ? equations.length() : 1.0) * row.blocks[own].diagonal();
  }
  return 1e-13 * equations.norm(largest);
}

// Adds to the report's counts, also when it fails.
void iterate(Equations& equations, const NewtonProblem& problem, BlockMatrix& matrix, LinearSolver& solver,
             const NewtonSettings& settings, bool search, NewtonReport& report) {
  Configuration& now = equations.system().state;
  const int last = report.iterations + settings.max_iterations;
  double size = 0;
  Eigen::VectorXd residual = problem.residual(size);
  std::string obstacle;
  const auto along = [&](const Eigen::VectorXd& r, const Eigen::VectorXd& u) {
    double work = 0;
    for (Eigen::Index i = 0; i < r.size(); ++i)
      if (!equations.fixed()[i]) work += r[i] * u[i];
    return std::abs(work);
  };
  for (;; ++report.iterations) {
    Eigen::VectorXd u = equations.missing(now.time_s);
    const double still = u.lpNorm<Eigen::Infinity>();
    const bool moving = still > 1e-12 * equations.length();
    const double norm = equations.norm(residual);
    report.residual = size > 0 ? norm / size : 0;
    if (!moving && norm <= settings.tolerance * size) return;
    if (report.iterations == last)
      throw NumericalFailure(
          "Newton's method: residual {:.3g} of the forces after {} iterations, largest at {}",
          report.residual, settings.max_iterations, equations.worst(residual));
    problem.tangent(matrix);
    report.linear = solver.solve(matrix, equations.fixed(), residual, u, now.x);
    const double round_off = force_round_off(equations, matrix);
    const double allowed = equations.allowed(u);
    const double start = along(residual, u);
    const Configuration before = now;
    Trial best, trial;
    double best_step = 0, step = allowed;
    for (int halving = 0;; ++halving) {
      now.x = before.x;
      now.rotation = before.rotation;
      equations.move(step * u);
      trial = {};
      try {
        trial.residual = problem.residual(trial.size);
        trial.sound = trial.residual.allFinite();
      } catch (const NumericalFailure& failure) {
        obstacle = failure.what();
      }
      if (trial.sound) {
        trial.norm = equations.norm(trial.residual);
        trial.along = along(trial.residual, u);
        if (!best.sound || trial.along < best.along) best = trial, best_step = step;
        if (moving || !search || trial.norm < norm || trial.along <= 0.5 * start) break;
      } else if (!search && settings.line_search) {
        throw NumericalFailure("Newton's method: a full step is not possible: {}", obstacle);
      }
      if (halving == settings.max_halvings) {
        if (!best.sound)
          throw NumericalFailure("Newton's method: no step is possible after {} halvings: {}", halving,
                                 obstacle);
        now.x = before.x;
        now.rotation = before.rotation;
        equations.move(best_step * u);
        trial = best;
        step = best_step;
        trial.residual = problem.residual(trial.size);  // terms may remember the last state they saw
        break;
      }
      step /= 2;
      ++report.halvings;
    }
    const bool tiny = step == 1 && !moving &&
                      u.head(3 * static_cast<Eigen::Index>(now.x.size())).lpNorm<Eigen::Infinity>() <=
                          settings.increment_tolerance * equations.length();
    residual = trial.residual;
    size = trial.size;
    if (tiny && equations.norm(residual) <= std::max(1e-4 * size, round_off)) {
      ++report.iterations;
      report.residual = size > 0 ? equations.norm(residual) / size : 0;
      return;
    }
  }
}

}  // namespace

NewtonReport newton(Equations& equations, const NewtonProblem& problem, BlockMatrix& matrix,
                    LinearSolver& solver, const NewtonSettings& settings) {
  NewtonReport report;
  if (!settings.search_first) {
    const Attempt start(equations, equations.system().state);
    try {
      iterate(equations, problem, matrix, solver, settings, false, report);
      return report;
    } catch (const NumericalFailure&) {
      if (!settings.line_search) throw;
    }
    start.undo(equations);
  }
  report.searched = true;
  iterate(equations, problem, matrix, solver, settings, true, report);
  return report;
}

}  // namespace valsalva::solve
