#include "simulation.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "place.hpp"

namespace valsalva::cycle {

namespace {

using state::Array;

std::unique_ptr<coupling::ImmersedShell> shell_of(MPI_Comm comm, const Leaflets& l, const Parameters& p) {
  structure::Shell shell(l.mesh, std::make_shared<materials::Hgo>(p.tissue.law),
                         structure::Bending{p.tissue.bending_modulus_Pa, 0.5});
  return std::make_unique<coupling::ImmersedShell>(comm, std::move(shell), l.rest, l.points, l.attached,
                                                   l.leaflet, p.spacing);
}

}  // namespace

Simulation::Simulation(MPI_Comm comm, const Inputs& in, const Parameters& p)
    : comm_(comm), in_(in), p_(p), rescue_(comm) {
  flow_ = std::make_unique<fluid::Flow>(comm, box_of(in, p.h, p.margin_cells), fluid::Boundaries{}, p.fluid);
  std::vector<int> device = mark_solids(in, p.masks, flow_->solids(), p.h);
  const fluid::Grid& grid = flow_->grid();
  const double area = std::min(flow_->open_area(0), flow_->open_area(grid.cells[2]));
  if (!(area > 0))
    throw InputError("{}: an end of the lumen is closed, at z = {:.2f} or {:.2f} mm; move the cuts",
                     in.parent.source, in.low_z_mm, in.high_z_mm);
  terminals_ = std::make_unique<Terminals>(p.circulation, p.initialisation_s,
                                           p.fluid.density * grid.h * grid.cells[2] / area);
  ends_ = std::make_unique<coupling::ImplicitEnds>(*flow_);
  ends_->add({fluid::End::low, [this] { return -flow_->flow_through(fluid::End::low); }});
  ends_->add({fluid::End::high, [this] { return flow_->flow_through(fluid::End::high); }});
  flow_->after_projection([this](double dt, const fluid::StepReport& found) { return meet_ends(dt, found); });
  system_ = std::make_unique<coupling::ImmersedFlow>(
      *flow_, in.leaflets ? shell_of(comm, *in.leaflets, p) : nullptr, p.coupling);
  recorder_ = std::make_unique<Recorder>(in, p, *system_, std::move(device));
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
    terminals_->begin(time_s_, dt, low, high);
    flow_->set_end_pressure(fluid::End::low, terminals_->low_pressure());
    flow_->set_end_pressure(fluid::End::high, terminals_->high_pressure());
  });
  time_s_ = last_.dt_s >= left ? p_.end_s : time_s_ + last_.dt_s;
  ++steps_;
  recorder_->after_step(time_s_, last_, *terminals_);
}

fluid::StepReport Simulation::meet_ends(double dt, const fluid::StepReport& found) {
  const std::array<coupling::Answer, 2> answers = terminals_->answers();
  if (!answers[0] && !answers[1]) return found;
  const fluid::StepReport report = ends_->settle(dt, found, {answers.begin(), answers.end()});
  terminals_->finish({ends_->outflow(0), ends_->outflow(1)},
                     {flow_->end_pressure(fluid::End::low), flow_->end_pressure(fluid::End::high)});
  return report;
}

void Simulation::step() {
  rescue_.before_step(steps_, *system_, [&] { return copy(); });
  try {
    advance();
  } catch (const NumericalFailure& failure) {
    const std::string why = fmt::format("{} ({})", failure.what(), worst_place(*flow_, system_->shell()));
    rescue_.go_back(why, *system_, [&](const state::State& copy) { return_to(copy); });
    log::warn("back to t = {:.5f} s, steps {:.2g} times as large: {}", time_s_, system_->caution(), why);
  }
}

coupling::Rescue::Arrays Simulation::copy() const {
  coupling::Rescue::Arrays out = system_->save();
  const Recorder::Mark mark = recorder_->mark();
  std::vector<double> values{time_s_, static_cast<double>(steps_), static_cast<double>(mark.rows),
                             static_cast<double>(mark.frames)};
  values.insert(values.end(), mark.sums.begin(), mark.sums.end());
  out["circulation"] = Array::of(terminals_->save());
  out["mark"] = Array::of(values);
  return out;
}

void Simulation::return_to(const state::State& copy) {
  const std::vector<double>& mark = copy.array("mark").doubles("mark");
  if (mark.size() != 10) throw InputError("{}: 'mark' has {} entries; expected 10", copy.source, mark.size());
  system_->load(copy);
  terminals_->restore(copy.array("circulation").doubles("circulation"));
  recorder_->return_to(
      {static_cast<std::size_t>(mark[2]), static_cast<std::size_t>(mark[3]), {mark.begin() + 4, mark.end()}});
  time_s_ = mark[0];
  steps_ = static_cast<long>(mark[1]);
}

std::map<std::string, Array> Simulation::save() const {
  std::map<std::string, Array> out = system_->save();
  out.merge(recorder_->save());
  out["circulation/state"] = Array::of(terminals_->save());
  out["cycle/progress"] = Array::of(std::vector<double>{time_s_, static_cast<double>(steps_)});
  out.merge(rescue_.save());
  return out;
}

void Simulation::load(const state::State& state) {
  system_->load(state);
  terminals_->restore(state.array("circulation/state").doubles("circulation/state"));
  recorder_->load(state);
  const std::vector<double>& progress = state.array("cycle/progress").doubles("cycle/progress");
  if (progress.size() != 2)
    throw InputError("{}: 'cycle/progress' has {} entries; expected 2", state.source, progress.size());
  time_s_ = progress[0];
  steps_ = static_cast<long>(progress[1]);
  rescue_.load(state);
}

}  // namespace valsalva::cycle
