// A strip clamped at x = 0, in nonlinear statics.
#pragma once

#include "shell_meshes.hpp"
#include "solve/statics.hpp"
#include "structure/dead_load.hpp"
#include "structure/kirchhoff_loads.hpp"

namespace valsalva::test {

struct KirchhoffStrip {
  SheetMesh sheet;
  std::shared_ptr<structure::KirchhoffShell> shell;
  structure::System system;
  structure::Body body;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;
  std::unique_ptr<solve::Statics> statics;
  std::vector<int> end;
  double length, width;

  KirchhoffStrip(double length_mm, double width_mm, double thickness, int cells, int across, Pattern pattern)
      : sheet(test::sheet(length_mm, width_mm, cells, across, pattern)), length(length_mm), width(width_mm) {
    structure::EdgeConditions conditions;
    for (const Edge& e : border_edges(sheet, [](double u, double) { return u == 0; }))
      conditions[e] = {structure::EdgeSupport::clamped, Vec3::Zero(), 0};
    shell = std::make_shared<structure::KirchhoffShell>(shell_mesh(sheet, sheet.plane, thickness),
                                                        structure::koiter_section(1.2e6, 0), conditions);
    body = system.add_body("strip", sheet.plane, shell->lumped_mass(1e-3));
    for (std::size_t a = 0; a < sheet.plane.size(); ++a) {
      if (sheet.plane[a].x() == 0) system.hold(static_cast<int>(a));
      if (sheet.plane[a].x() == length) end.push_back(static_cast<int>(a));
    }
    terms.push_back(std::make_shared<structure::KirchhoffTerm>(shell, body));
  }

  void shear(double load) {
    Points force(sheet.plane.size(), Vec3::Zero());
    for (int a : end) {
      const double v = sheet.plane[a].y();
      force[a].z() = load / (end.size() - 1) * (v == 0 || v == width ? 0.5 : 1);
    }
    terms.push_back(
        std::make_shared<structure::DeadLoadTerm>("shear", force, Points{}, [](double t) { return t; }));
    start(0.05);
  }

  /// The whole moment; lifts the end.
  void moment(double value) {
    const std::vector<Edge> edges = border_edges(sheet, [this](double u, double) { return u == length; });
    terms.push_back(std::make_shared<structure::EdgeMomentTerm>(
        "moment", shell, body, edges, [=, this](double t) { return value / width * t; }));
    start(0.02);
  }

  void start(double first_step) {
    solve::StaticsSettings settings;
    settings.first_step = first_step;
    settings.max_step = 0.05;
    statics = std::make_unique<solve::Statics>(system, terms, solve::Supports{}, settings);
  }

  Vec3 tip(double factor) {
    statics->advance_to(factor);
    Vec3 mean = Vec3::Zero();
    for (int a : end) mean += system.state.x[a] / double(end.size());
    return mean - Vec3(length, 0.5 * width, 0);
  }
};

}  // namespace valsalva::test
