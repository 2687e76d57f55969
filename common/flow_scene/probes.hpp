// [[flow_probe]]: columns of history.csv, and profiles along lines as files of their own.
//
//   kinetic_energy   int rho u^2 / 2 dV                                      nJ
//   dissipation      int 2 mu S:S dV, S the symmetric velocity gradient      nJ/s
//   enstrophy        int |rot u|^2 / 2 dV                                    mm3/s2
//   momentum         of the box, and of what bodies have beyond the fluid's density    g mm/s
// over the cells that are not solid; squares of differences across a cell's edges are averaged over its four
// edges of that direction. Errors: over all faces (pressure: cells) that are not solid, in the norm
// sqrt(mean |.|^2) or the largest; the means of both pressures are taken off.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/case.hpp"
#include "flow_scene/bodies.hpp"
#include "flow_scene/obstacles.hpp"
#include "flow_scene/sides.hpp"

namespace valsalva::flow_scene {

/// What probes look at.
struct Measured {
  fluid::Flow& flow;
  const Frame& frame;
  const Obstacles& obstacles;
  double time_s = 0;
  double step_s = 0;               ///< the last
  const Bodies* bodies = nullptr;  ///< null: none
};

class Probes {
 public:
  /// InputError that names the entry.
  Probes(const Case& scene, const Sides& sides, const Obstacles& obstacles, const Bodies* bodies);

  const std::vector<std::string>& columns() const { return columns_; }
  /// One value a column (collective).
  std::vector<double> values(const Measured& now) const;

  /// Adds the present state to the means of the profiles.
  void add_to_means(const Measured& now);
  /// Lines as tables: file name and text; on all ranks.
  std::vector<std::pair<std::string, std::string>> profiles(const Measured& now) const;

  std::vector<double> save() const;
  void restore(const std::vector<double>& saved);

 private:
  using Measure = std::function<void(const Measured&, std::vector<double>&)>;
  struct Line {
    std::string name;
    Points points;
    std::vector<double> s_mm, sum;  ///< sum: u, v, w, p of each point
    double count = 0;
  };
  std::vector<double> on_line(const Line& line, const Measured& now) const;

  std::vector<std::string> columns_;
  std::vector<Measure> measures_;
  std::vector<Line> lines_;
};

}  // namespace valsalva::flow_scene
