// The running cycle: fluid, leaflets, circulation and recorder, advanced step by step, with the rescue from
// alarms (coupling/rescue.hpp).
#pragma once

#include <memory>

#include "coupling/implicit_ends.hpp"
#include "coupling/rescue.hpp"
#include "inputs.hpp"
#include "recorder.hpp"
#include "terminals.hpp"

namespace valsalva::cycle {

class Simulation {
 public:
  Simulation(MPI_Comm comm, const Inputs& in, const Parameters& p);
  Simulation(const Simulation&) = delete;  // the flow calls back
  Simulation& operator=(const Simulation&) = delete;

  double time_s() const { return time_s_; }
  long steps() const { return steps_; }
  bool finished() const { return time_s_ >= p_.end_s; }
  /// NumericalFailure when the rescue is exhausted: the state is then the last good one.
  void step();

  const fluid::Flow& flow() const { return *flow_; }
  const coupling::ImmersedShell* shell() const { return system_->shell(); }
  const Recorder& recorder() const { return *recorder_; }
  const Terminals& terminals() const { return *terminals_; }
  const coupling::ImmersedStep& last_step() const { return last_; }
  long returns() const { return rescue_.returns(); }

  /// Restart entries, complete on rank 0 (collective); load continues bitwise at equal ranks.
  std::map<std::string, state::Array> save() const;
  void load(const state::State& state);

 private:
  /// All of it, with the recorder's mark instead of what it has recorded, which only grows.
  coupling::Rescue::Arrays copy() const;
  void return_to(const state::State& copy);
  void advance();
  fluid::StepReport meet_ends(double dt, const fluid::StepReport& found);

  MPI_Comm comm_;
  const Inputs& in_;
  const Parameters& p_;
  std::unique_ptr<fluid::Flow> flow_;
  std::unique_ptr<coupling::ImmersedFlow> system_;
  std::unique_ptr<Terminals> terminals_;
  std::unique_ptr<coupling::ImplicitEnds> ends_;
  std::unique_ptr<Recorder> recorder_;
  coupling::Rescue rescue_;
  coupling::ImmersedStep last_;
  double time_s_ = 0;
  long steps_ = 0;
};

}  // namespace valsalva::cycle
