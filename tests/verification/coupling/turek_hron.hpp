// The benchmarks of Turek and Hron 2006 in a thin slab: a bar of St. Venant-Kirchhoff solid behind a cylinder
// in a channel. Here z runs downstream, x across the channel (up), y through the slab (periodic; the bar's
// nodes are held in y: plane strain). mm, g, s.
#pragma once

#include <memory>
#include <vector>

#include "coupling/immersed_flow.hpp"
#include "coupling/immersed_structure.hpp"
#include "structure/solid.hpp"

namespace valsalva::turek {

struct Bar {
  int along = 18, across = 1;  ///< hex27 elements; one through the slab
  double slab_mm = 20;
  double shear_Pa = 0.5e6, poisson = 0.4;
  double density = 1e-3;  ///< g/mm3
};

/// The bar in a System of its own, held on the cylinder and in y; node 'tip' is at the point A.
struct BuiltBar {
  std::unique_ptr<structure::System> system;
  std::shared_ptr<structure::Solid> solid;
  structure::Body body;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;
  int tip = 0;
};
BuiltBar build(const Bar& bar);

struct Channel {
  int cells_across = 41;  ///< 410 mm; multiples of it
  double length_mm = 2500;
  double mean_mm_per_s = 200;  ///< of the parabolic inflow
  double ramp_s = 0;           ///< 0: starts with the channel's profile everywhere
  std::string kernel = "ib4";
  bool sampled = true;  ///< coupling by element quadrature (spacing 0.6 h); otherwise at the nodes
  fluid::Wall wall = fluid::Wall::interpolated;
  Bar bar;
};

struct Reading {
  double time_s, tip_down_mm, tip_across_mm;  ///< displacement of A along z and x
  double drag_N_per_m, lift_N_per_m;          ///< on cylinder and bar; without the bar's inertia
  double bar_pull_N_per_m;                    ///< the bar's share of the drag
  double max_speed;                           ///< mm/s
  double dt_s, critical_s;
};

class Case {
 public:
  explicit Case(const Channel& channel);
  Reading step();
  const coupling::ImmersedFlow& system() const { return *system_; }
  const coupling::ImmersedStructure& bar() const { return *bar_; }
  double time_s() const { return time_s_; }
  fluid::Flow& flow() { return *flow_; }

 private:
  double inflow(const Vec3& x) const;
  Channel channel_;
  std::unique_ptr<fluid::Flow> flow_;
  std::unique_ptr<coupling::ImmersedFlow> system_;
  coupling::ImmersedStructure* bar_ = nullptr;
  int tip_ = 0, foot_ = 0;
  Vec3 start_;
  double time_s_ = 0;
};

/// Mean and amplitude ((max + min)/2, (max - min)/2) over the last periods of a signal and the frequency from
/// its upward crossings of the mean; frequency 0 when there are fewer than two.
struct Oscillation {
  double mean = 0, amplitude = 0, frequency_Hz = 0;
  int periods = 0;
};
Oscillation oscillation(const std::vector<double>& time_s, const std::vector<double>& value, double from_s);

}  // namespace valsalva::turek
