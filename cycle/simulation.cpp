#include "simulation.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/log.hpp"

namespace valsalva::cycle {

namespace {

using state::Array;

constexpr long memory_interval = 200;
constexpr long most_recent_returns = 4;
constexpr double caution_after_alarm = 0.6, caution_recovery = 1.25;
constexpr const char* rescue_prefix = "rescue/";

std::unique_ptr<coupling::ImmersedShell> shell_of(MPI_Comm comm, const Leaflets& l, const Parameters& p) {
  structure::Shell shell(l.mesh, std::make_shared<materials::Hgo>(p.tissue.law),
                         structure::Bending{p.tissue.bending_modulus_Pa, 0.5});
  return std::make_unique<coupling::ImmersedShell>(comm, std::move(shell), l.rest, l.points, l.attached,
                                                   l.leaflet, p.spacing);
}

/// Everybody gets what rank 0 has.
void broadcast(MPI_Comm comm, std::map<std::string, Array>& arrays) {
  if (mpi::size(comm) == 1) return;
  const bool first = mpi::rank(comm) == 0;
  const auto text = [&](std::string& s) {
    std::uint64_t n = s.size();
    MPI_Bcast(&n, 1, MPI_UINT64_T, 0, comm);
    s.resize(n);
    MPI_Bcast(s.data(), static_cast<int>(n), MPI_CHAR, 0, comm);
  };
  std::uint64_t count = arrays.size();
  MPI_Bcast(&count, 1, MPI_UINT64_T, 0, comm);
  std::vector<std::string> names;
  for (const auto& [name, array] : arrays) names.push_back(name);
  names.resize(count);
  for (std::string& name : names) {
    text(name);
    Array& array = arrays[name];
    std::vector<double> values;
    if (first) values = array.doubles(name);
    std::array<std::uint64_t, 2> sizes{values.size(), array.shape.size()};
    MPI_Bcast(sizes.data(), 2, MPI_UINT64_T, 0, comm);
    values.resize(sizes[0]);
    std::vector<std::uint64_t> shape(array.shape.begin(), array.shape.end());
    shape.resize(sizes[1]);
    MPI_Bcast(shape.data(), static_cast<int>(shape.size()), MPI_UINT64_T, 0, comm);
    MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, 0, comm);
    if (!first) array = Array::of(std::move(values), std::vector<std::size_t>(shape.begin(), shape.end()));
  }
}

}  // namespace

Simulation::Simulation(MPI_Comm comm, const Inputs& in, const Parameters& p) : comm_(comm), in_(in), p_(p) {
  flow_ = std::make_unique<fluid::Flow>(comm, box_of(in, p.h, p.margin_cells), fluid::Boundaries{}, p.fluid);
  std::vector<int> device = mark_solids(in, p.masks, flow_->solids(), p.h);
  const fluid::Grid& grid = flow_->grid();
  const double area = std::min(flow_->open_area(0), flow_->open_area(grid.cells[2]));
  if (!(area > 0))
    throw InputError("{}: an end of the lumen is closed, at z = {:.2f} or {:.2f} mm; move the cuts",
                     in.parent.source, in.low_z_mm, in.high_z_mm);
  terminals_ = std::make_unique<Terminals>(p.circulation, p.initialisation_s,
                                           p.fluid.density * grid.h * grid.cells[2] / area);
  system_ = std::make_unique<coupling::ImmersedFlow>(
      *flow_, in.leaflets ? shell_of(comm, *in.leaflets, p) : nullptr, p.coupling);
  recorder_ = std::make_unique<Recorder>(in, p, *system_, std::move(device));
  remember();
}

void Simulation::advance() {
  const double left = p_.end_s - time_s_;
  if (system_->shell())
    system_->shell()->set_repulsion_growth(
        p_.initialisation_s > 0 ? std::min(1.0, time_s_ / p_.initialisation_s) : 1.0);
  const double low = flow_->flow_through(fluid::End::low), high = flow_->flow_through(fluid::End::high);
  const std::vector<double> before = terminals_->save();
  last_ = system_->step(left, [&](double dt) {
    terminals_->restore(before);
    terminals_->advance(time_s_, dt, low, high);
    flow_->set_end_pressure(fluid::End::low, terminals_->low_pressure());
    flow_->set_end_pressure(fluid::End::high, terminals_->high_pressure());
  });
  time_s_ = last_.dt_s >= left ? p_.end_s : time_s_ + last_.dt_s;
  ++steps_;
  recorder_->after_step(time_s_, last_, *terminals_);
}

void Simulation::step() {
  try {
    advance();
  } catch (const NumericalFailure& failure) {
    go_back(failure.what());
    return;
  }
  if (steps_ % memory_interval == 0) {
    if (steps_ > memory_.steps) {
      system_->set_caution(std::min(1.0, system_->caution() * caution_recovery));
      recent_returns_ = 0;
    }
    remember();
  }
}

void Simulation::remember() {
  memory_ = {system_->save(), terminals_->save(), recorder_->mark(), time_s_, steps_};
}

void Simulation::go_back(const std::string& why) {
  ++returns_;
  ++recent_returns_;
  const double caution = system_->caution() * caution_after_alarm;
  state::State state;
  state.source = "the copy in memory";
  state.restart = memory_.arrays;
  broadcast(comm_, state.restart);
  system_->load(state);
  terminals_->restore(memory_.terminals);
  recorder_->return_to(memory_.mark);
  time_s_ = memory_.time_s;
  steps_ = memory_.steps;
  system_->set_caution(caution);
  if (recent_returns_ > most_recent_returns)
    throw NumericalFailure(
        "cycle: no way past t = {:.6f} s after {} returns with smaller steps; the last alarm: {}", time_s_,
        most_recent_returns, why);
  log::warn("back to t = {:.5f} s, steps {} times smaller: {}", time_s_, 1 / caution, why);
}

std::map<std::string, Array> Simulation::save() const {
  std::map<std::string, Array> out = system_->save();
  out.merge(recorder_->save());
  out["circulation/state"] = Array::of(terminals_->save());
  out["cycle/progress"] =
      Array::of(std::vector<double>{time_s_, static_cast<double>(steps_), static_cast<double>(returns_),
                                    static_cast<double>(recent_returns_)});
  if (memory_.steps == steps_) return out;
  // An alarm after a restart has to lead back to the same step as in the run without.
  for (const auto& [name, array] : memory_.arrays) out[rescue_prefix + name] = array;
  out[std::string(rescue_prefix) + "circulation"] = Array::of(memory_.terminals);
  std::vector<double> mark{memory_.time_s, static_cast<double>(memory_.steps),
                           static_cast<double>(memory_.mark.rows), static_cast<double>(memory_.mark.frames)};
  mark.insert(mark.end(), memory_.mark.sums.begin(), memory_.mark.sums.end());
  out[std::string(rescue_prefix) + "mark"] = Array::of(mark);
  return out;
}

void Simulation::load(const state::State& state) {
  system_->load(state);
  terminals_->restore(state.array("circulation/state").doubles("circulation/state"));
  recorder_->load(state);
  const std::vector<double>& progress = state.array("cycle/progress").doubles("cycle/progress");
  if (progress.size() != 4)
    throw InputError("{}: 'cycle/progress' has {} entries; expected 4", state.source, progress.size());
  time_s_ = progress[0];
  steps_ = static_cast<long>(progress[1]);
  returns_ = static_cast<long>(progress[2]);
  recent_returns_ = static_cast<long>(progress[3]);
  remember();
  const std::string prefix = rescue_prefix;
  if (!state.has_array(prefix + "mark")) return;
  memory_.arrays.clear();
  for (const auto& [name, array] : state.restart)
    if (name.rfind(prefix, 0) == 0) memory_.arrays[name.substr(prefix.size())] = array;
  memory_.terminals = memory_.arrays.at("circulation").doubles("rescue/circulation");
  const std::vector<double> mark = memory_.arrays.at("mark").doubles("rescue/mark");
  memory_.arrays.erase("circulation");
  memory_.arrays.erase("mark");
  if (mark.size() != 10)
    throw InputError("{}: 'rescue/mark' has {} entries; expected 10", state.source, mark.size());
  memory_.time_s = mark[0];
  memory_.steps = static_cast<long>(mark[1]);
  memory_.mark = {
      static_cast<std::size_t>(mark[2]), static_cast<std::size_t>(mark[3]), {mark.begin() + 4, mark.end()}};
}

}  // namespace valsalva::cycle
