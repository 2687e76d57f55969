// A scene of fluid (docs/flow-scenes.md): box, sides, obstacles, bodies and probes of a case file around a
// Flow, and its march in time.
//
// Steps meet the rows of the history exactly. step_s, or as large as
//   dt (|u|+|v|+|w|) / h <= cfl       (of fluid, sides and moving obstacles)
//   dt <= c h^2 / nu                  c = 1/14 for ab2, 0.18 for rk3; none where viscosity is implicit
// allow, and at most 1.2 times the step before. What is prescribed over time is taken at the end of each step
// (rk3: of each stage), body forces in its middle. With deformable bodies the structure's limit counts too,
// and after an alarm the run goes back (coupling/rescue.hpp).
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "core/run_folder.hpp"
#include "coupling/rescue.hpp"
#include "flow_scene/bodies.hpp"
#include "flow_scene/obstacles.hpp"
#include "flow_scene/probes.hpp"
#include "flow_scene/sides.hpp"
#include "fluid/flow.hpp"
#include "state/state.hpp"

namespace valsalva::flow_scene {

/// Does the case give [fluid] a box?
bool has_box(const Case& scene);

class FlowScene {
 public:
  /// InputError that names file and key.
  FlowScene(const Case& scene, MPI_Comm comm);
  FlowScene(const FlowScene&) = delete;

  double time_s() const { return time_s_; }
  double end_s() const { return end_s_; }
  long steps() const { return steps_; }
  double step_s() const { return step_s_; }  ///< the last
  bool finished() const { return row_ >= rows_; }
  bool row_due() const { return row_due_; }  ///< after a step: does it end on a row?
  fluid::Flow& flow() { return *flow_; }
  const Frame& frame() const { return sides_.frame(); }
  const Obstacles& obstacles() const { return obstacles_; }
  Bodies* bodies() { return bodies_.get(); }  ///< null: none
  const Bodies* bodies() const { return bodies_.get(); }

  double stable_s() const;                               ///< what cfl and viscosity allow now
  double given_step_s() const { return given_step_s_; }  ///< 0: none
  /// Collective; NumericalFailure when the velocity is not finite (with bodies: and there is no way back).
  void step();

  const History& history() const { return history_; }
  /// A row of the probes as things stand; NumericalFailure when a value is not finite.
  void add_row();
  std::vector<std::pair<std::string, std::string>> profiles();
  /// Last values, and means, extremes and frequencies of the averaged part of the history.
  std::map<std::string, double> metrics() const;

  /// All that the continuation needs, on rank 0, and back on every rank.
  std::map<std::string, state::Array> save() const;
  void load(const state::State& state);
  /// Velocity and pressure at cell centres, and 1 where there is an obstacle, in the axes of the case.
  state::Image image() const;

 private:
  Measured measured() { return {*flow_, sides_.frame(), obstacles_, time_s_, step_s_, bodies_.get()}; }
  double next_step_s() const;
  void set_force(double time_s);
  void add_force_again(double time_s);
  void prescribe(double time_s);
  void step_with_bodies();
  void finish_step(double start_s, double dt_s, double row_s, bool meets_row, double max_speed);
  std::map<std::string, state::Array> save_run() const;
  void load_run(const state::State& state);
  void start(const Case& scene);

  Sides sides_;
  fluid::Grid grid_;  ///< axes of the solver
  Obstacles obstacles_;
  std::unique_ptr<Bodies> bodies_;
  std::unique_ptr<fluid::Flow> flow_;
  Probes probes_;
  History history_;
  VectorExpression force_;
  bool rk3_;
  double cfl_, given_step_s_, end_s_, average_from_s_, zero_shear_viscosity_ = 0;
  long rows_, row_ = 0, steps_ = 0;
  double time_s_ = 0, step_s_ = 0, speed_ = 0;
  bool row_due_ = false, forced_ = false;
  std::optional<fluid::FaceField> constant_force_;  // with bodies: what their forces are added to
  coupling::Rescue rescue_;
};

}  // namespace valsalva::flow_scene
