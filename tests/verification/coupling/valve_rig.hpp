// A trileaflet valve in a straight tube that closes under a rising aortic pressure, on any grid.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "core/units.hpp"
#include "coupling/immersed_flow.hpp"
#include "synthetic_valve.hpp"

namespace valsalva::test {

/// The valve, its tube and the coupled solver.
struct ValveRig {
  ValveMesh mesh;
  std::unique_ptr<fluid::Flow> flow;
  std::unique_ptr<coupling::ImmersedFlow> system;
  double time_s = 0;

  explicit ValveRig(double h = 1.5) : ValveRig(h, {{2e5, 0.6 * h}, 1.3 * h}) {}
  ValveRig(double h, const coupling::Spacing& spacing) {
    constexpr double radius = 12.5;
    SyntheticValve valve;
    valve.spacing_mm = 0.5 * h;
    mesh = synthetic_valve(valve);
    const int across = static_cast<int>(std::lround(36 / h)), along = static_cast<int>(std::lround(45 / h));
    const fluid::Grid grid{{across, across, along}, Vec3(-18, -18, -15), h};
    flow = std::make_unique<fluid::Flow>(MPI_COMM_SELF, grid, fluid::Boundaries{}, fluid::FlowParameters{});
    flow->solids().set_lumen([](const Vec3& x) { return std::hypot(x.x(), x.y()) - radius; });
    const int ring = flow->solids().add_body("ring");
    flow->solids().mark_segments(ring, mesh.shell.reference, mesh.attachment, 0.8 * h);
    auto shell = std::make_unique<coupling::ImmersedShell>(MPI_COMM_SELF, pericardial_shell(mesh),
                                                           mesh.shell.reference, mesh.shell.reference,
                                                           mesh.attached, mesh.leaflet, spacing);
    system =
        std::make_unique<coupling::ImmersedFlow>(*flow, std::move(shell), coupling::ImmersedFlowSettings{});
  }

  /// The aorta rises to 40 mmHg in 10 ms behind a characteristic resistance.
  void run_to(double end_s, const std::function<void(const coupling::ImmersedStep&)>& look) {
    while (time_s < end_s) {
      const double flow_mL = flow->flow_through(fluid::End::high) / 1e3;
      const coupling::ImmersedStep step = system->step(end_s - time_s, [&](double dt) {
        const double s = std::min(1.0, (time_s + dt) / 0.01);
        flow->set_end_pressure(fluid::End::high,
                               units::pa_per_mmHg * (40 * s * s * (3 - 2 * s) + 0.042 * flow_mL));
      });
      time_s = step.dt_s >= end_s - time_s ? end_s : time_s + step.dt_s;
      look(step);
    }
  }
};

}  // namespace valsalva::test
