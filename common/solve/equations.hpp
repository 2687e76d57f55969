// The unknowns of a System in implicit solution: which move, which are prescribed, and Newton's method.
//
// Unknowns: 3 a slot of structure::BlockMatrix, in space, or, where the System holds a slot along directions
// that are not coordinate axes, in a frame of its own (`local`); node increments are added, rotations turned
// by the exponential of the spin, R <- exp(w) R. The force terms are those of the explicit integrator; each
// brings its tangent by ForceTerm::add_tangent.
//
// Newton: K du = r with the prescribed motion still missing as given part of du. An increment that would take
// bodies through each other is cut to the share that the terms allow. When a full step reverses an element,
// or this does not converge, it starts again with a line search: steps are halved when they reverse an
// element or neither |r| falls nor |r . du| to its half (Crisfield 1991, section 9.2; not while prescribed
// motion is missing, when both may rise). Force evaluations cost a thirtieth of an iteration: a search that
// is satisfied with less costs more (docs/results/structure-bench.md). The search comes second because
// slender bodies converge through states of large residual. Converged when the prescribed motion is complete
// and |r| <= tolerance x (sum of the norms of the terms' forces, moments divided by the length of the scene),
// or when the increment is below increment_tolerance x length and |r| below 1e-4 of that sum, where round-off
// stops, or, where hardly any force acts and the sum is round-off too, below 1e-13 of the stiffness times the
// length.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "solve/linear_solver.hpp"
#include "structure/force_term.hpp"

namespace valsalva::solve {

/// What is held or moved, besides what the System holds (nodes in all components and in rotation, directions,
/// axes). Components are those of space; they cannot be given where the System holds a skew direction.
class Supports {
 public:
  using Motion = std::function<double(double)>;  ///< displacement in mm, of time (load factor)
  void fix(int node);
  void fix(int node, int component);
  void fix_rotation(int rotation);
  void fix_rotation(int rotation, int component);
  /// From the node's position when the equations are set up.
  void move(int node, int component, Motion displacement);
  /// All of a rotation: turned, in space, from where it is when the equations are set up.
  using Turning = std::function<Mat3(double)>;  ///< of time (load factor)
  void turn(int rotation, Turning rotated);

 private:
  friend class Equations;
  struct Turned {
    int rotation;
    Turning turning;
  };
  struct Entry {
    int index, component;
    bool rotation;
    Motion motion;
  };
  std::vector<Entry> entries_;
  std::vector<Turned> turned_;
};

struct NewtonSettings {
  double tolerance = 1e-8;
  double increment_tolerance = 1e-11;
  int max_iterations = 25;
  int max_halvings = 8;
  bool line_search = true;    ///< when plain iterations fail
  bool search_first = false;  ///< no plain ones: Statics sets it once they have failed
};

struct NewtonReport {
  int iterations = 0;     ///< plain ones that failed included
  bool searched = false;  ///< the line search was needed
  int halvings = 0;
  double residual = 0;  ///< relative
  LinearReport linear;  ///< of the last solve
};

class Equations {
 public:
  Equations(structure::System& system, std::vector<std::shared_ptr<structure::ForceTerm>> terms,
            const Supports& supports);

  structure::System& system() const { return system_; }
  const std::vector<std::shared_ptr<structure::ForceTerm>>& terms() const { return terms_; }
  int unknowns() const { return static_cast<int>(fixed_.size()); }
  int free_unknowns() const;
  const std::vector<std::uint8_t>& fixed() const { return fixed_; }
  double length() const { return length_; }

  /// Forces and moments of all terms at the present state (`local`); `size`: the sum of the norms term by
  /// term, `stored`: the energy.
  Eigen::VectorXd forces(double& size, double& stored) const;
  /// From components in space to those of the unknowns, and back.
  Eigen::VectorXd local(Eigen::VectorXd v) const;
  Eigen::VectorXd in_space(Eigen::VectorXd v) const;
  /// The tangent of all terms; set to zero first.
  void tangent(structure::BlockMatrix& k) const;
  structure::BlockMatrix matrix() const { return {system_.nodes(), system_.rotational_nodes()}; }
  void move(const Eigen::VectorXd& increment);
  /// The share of an increment that the terms allow (ForceTerm::allowed_motion); the state stays.
  double allowed(const Eigen::VectorXd& increment);
  /// Prescribed minus present positions (rotations: the spin that is missing) where fixed, zero elsewhere.
  Eigen::VectorXd missing(double time_s) const;
  /// Norm over the free unknowns, moments divided by the length.
  double norm(const Eigen::VectorXd& r) const;
  double norm_of_all(const Eigen::VectorXd& r) const;
  /// The free node with the largest entry.
  std::string worst(const Eigen::VectorXd& r) const;

 private:
  structure::System& system_;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms_;
  std::vector<std::uint8_t> fixed_;
  struct Prescribed {
    int unknown;
    double start;
    Supports::Motion motion;
  };
  std::vector<Prescribed> prescribed_;
  struct Turned {
    int rotation;
    Eigen::Quaterniond start;
    Supports::Turning turning;
  };
  std::vector<Turned> turned_;
  std::map<int, Mat3> frames_;  // of slots held along skew directions; columns: their axes
  void hold_along(int slot, const Mat3& projector);
  double length_ = 1;
};

/// What differs between an equilibrium and a time step.
struct NewtonProblem {
  std::function<Eigen::VectorXd(double& size)> residual;  ///< at the present state
  std::function<void(structure::BlockMatrix&)> tangent;   ///< -d(residual)
};

/// Brings the system to residual zero at its time. NumericalFailure, with the state left where it stopped.
NewtonReport newton(Equations& equations, const NewtonProblem& problem, structure::BlockMatrix& matrix,
                    LinearSolver& solver, const NewtonSettings& settings);

/// Everything that a failed attempt may have changed.
struct Attempt {
  explicit Attempt(const Equations& equations, const structure::Configuration& state);
  void undo(Equations& equations) const;

 private:
  structure::Configuration state_;
  std::vector<structure::Snapshot> terms_;
};

}  // namespace valsalva::solve
