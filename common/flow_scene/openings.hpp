// Openings of a vessel on planes inside the box: [[opening]] as the flow's openings, and what they prescribe
// over time. Axes of the case.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/case.hpp"
#include "flow_scene/frame.hpp"
#include "flow_scene/obstacles.hpp"
#include "flow_scene/prescribed.hpp"
#include "fluid/flow.hpp"

namespace valsalva::flow_scene {

class Openings {
 public:
  /// InputError that names the entry.
  explicit Openings(const Case& scene);
  /// A whole side of the box, where the pressure is known; its number.
  int add_side(const std::string& name, int axis, int side, const KnownPressure& pressure);

  bool any() const { return !openings_.empty(); }
  bool have_known_pressure() const;
  /// Null where the flow is known.
  const KnownPressure* pressure(int opening) const {
    return openings_[opening].pressure ? &*openings_[opening].pressure : nullptr;
  }
  int count() const { return static_cast<int>(openings_.size()); }
  int find(const std::string& name, const std::string& what) const;

  /// After the obstacles, and before the flow's velocity is set. more_cells(axis, side): of the box beyond a
  /// side that is an opening.
  void place(fluid::Flow& flow, const Frame& frame, const Obstacles& obstacles);
  void set(fluid::Flow& flow, double time_s) const;
  void advance(const fluid::Flow& flow, double time_s, double dt_s);
  /// Out of the fluid, mm3/s (collective).
  double outflow(const fluid::Flow& flow, int opening) const;
  /// That known flows prescribe now, mm/s (of this rank).
  double largest_speed(const fluid::Flow& flow) const;

  std::vector<double> save() const;
  void restore(const std::vector<double>& saved, std::size_t& at);

 private:
  struct Opening {
    std::string name, what, profile;
    Vec3 centre = Vec3::Zero(), normal = Vec3::UnitZ();
    double radius = 1e300;
    int side_axis = -1, side = 0;           ///< a side of the box
    std::optional<KnownPressure> pressure;  ///< none: the flow is known
    double inflow = 0;                      ///< mm3/s, at factor 1
    std::shared_ptr<Factor> factor;
  };
  std::vector<Opening> openings_;
};

}  // namespace valsalva::flow_scene
