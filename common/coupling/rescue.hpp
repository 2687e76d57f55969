// The way back from an alarm (a node or the fluid too fast, an element stretched too far, a value that is not
// finite): every 200 steps a copy of everything is kept in memory; after an alarm the run returns to it and
// goes on with steps 0.6 times as large; each copy that is reached without an alarm makes them 1.25 times as
// large again, up to what they were. After more than four returns without progress the run fails.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "coupling/immersed_flow.hpp"
#include "state/state.hpp"

namespace valsalva::coupling {

class Rescue {
 public:
  using Arrays = std::map<std::string, state::Array>;

  explicit Rescue(MPI_Comm comm) : comm_(comm) {}

  /// Before every step: takes a copy where one is due. save(): all of the run, complete on rank 0.
  void before_step(long steps, ImmersedFlow& system, const std::function<Arrays()>& save);
  /// After an alarm, on all ranks: load() is given the copy, complete on every rank. NumericalFailure that
  /// says why when there have been too many returns; the state is then that of the copy.
  void go_back(const std::string& why, ImmersedFlow& system,
               const std::function<void(const state::State&)>& load);
  long returns() const { return returns_; }

  /// What a bitwise continuation needs, below "rescue/".
  Arrays save() const;
  void load(const state::State& state);

 private:
  MPI_Comm comm_;
  Arrays copy_;
  long steps_ = -1;  // of the copy; -1: none
  long returns_ = 0, recent_ = 0;
};

}  // namespace valsalva::coupling
