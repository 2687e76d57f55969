// The six sides of the box: [[boundary]] as the flow's boundaries, and what they prescribe over time; with
// the openings inside the box. Outflow sides of one axis are the flow's open sides; those of further axes
// become openings, for which the box is some cells longer there.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/case.hpp"
#include "coupling/implicit_ends.hpp"
#include "flow_scene/expression.hpp"
#include "flow_scene/frame.hpp"
#include "flow_scene/openings.hpp"
#include "flow_scene/prescribed.hpp"
#include "fluid/flow.hpp"

namespace valsalva::flow_scene {

struct SideOfBox {
  int axis = 0;  ///< of the case
  int side = 0;  ///< 0 low, 1 high
};
/// Of "x_low" and so on; InputError with `what`.
SideOfBox side_from(const std::string& name, const std::string& what);

class Sides {
 public:
  /// InputError that names the entry: a side twice, open sides along two axes, profiles without speed ...
  explicit Sides(const Case& scene);
  Sides(const Sides&) = delete;
  Sides& operator=(const Sides&) = delete;

  const Frame& frame() const { return frame_; }
  bool periodic(int case_axis) const { return kind_[case_axis][0] == fluid::Side::periodic; }
  bool slip(int case_axis) const {
    return kind_[case_axis][0] == fluid::Side::slip && kind_[case_axis][1] == fluid::Side::slip;
  }
  /// May the box be a part of a cell longer there?
  bool ends_anywhere(int case_axis) const {
    return kind_[case_axis][1] == fluid::Side::open || kind_[case_axis][1] == fluid::Side::slip;
  }
  bool has_outflow() const;
  /// Is the pressure to be that of the fluid's cells alone (fluid/krylov_pressure.hpp)?
  bool fluid_cells() const { return fluid_cells_; }
  /// Cells by which the box is longer than the case says.
  int more_cells(int case_axis, int side) const { return cut_[case_axis][side] < 0 ? 0 : fluid::ghosts; }
  Openings& openings() { return openings_; }
  const Openings& openings() const { return openings_; }
  /// Out of the box through a side, mm3/s (collective).
  double side_flow(const fluid::Flow& flow, const SideOfBox& side) const;
  /// In the solver's axes.
  fluid::Boundaries boundaries() const;

  /// Models behind places of known pressure that answer steeply are solved together with the flow's steps
  /// from now on (coupling/implicit_ends.hpp); the others answer after each step. The flow must outlive this
  /// object.
  void couple(fluid::Flow& flow);
  /// Sets everything that is prescribed, as it is at time_s, within a step from start_s. The flow's obstacles
  /// must stand. InputError when a box without outflow is asked to take in more than it lets out.
  void set(fluid::Flow& flow, double start_s, double time_s);
  /// After a step: what stands behind the outflow sides answers.
  void advance(fluid::Flow& flow, double time_s, double dt_s);
  /// The largest |u|+|v|+|w| that sides prescribe now, mm/s (collective).
  double largest_speed(const fluid::Flow& flow) const;

  std::vector<double> save() const;
  void restore(const std::vector<double>& saved);

 private:
  struct Entry {
    std::string what;
    fluid::Side kind = fluid::Side::wall;
    std::vector<SideOfBox> sides;
    std::shared_ptr<VectorExpression> velocity;
    std::string profile = "given";
    Vec3 centre = Vec3::Zero();
    double radius = 0, speed = 0, mean = 0, flow_mm3 = 0;
    std::shared_ptr<Factor> factor;
  };
  struct Outlet {
    int end = 0;
    KnownPressure pressure;
  };
  Entry read(const Case& scene, const Case& entry) const;
  void set_inflow(fluid::Flow& flow, const Entry& entry, const SideOfBox& side, double time_s) const;
  void balance(fluid::Flow& flow) const;
  fluid::StepReport meet_models(double dt_s, const fluid::StepReport& found);

  std::vector<Entry> entries_;
  std::array<std::array<fluid::Side, 2>, 3> kind_{};  ///< in the axes of the case
  std::array<std::array<int, 2>, 3> entry_of_{};      ///< -1: none
  std::array<std::array<int, 2>, 3> cut_{};           ///< side as an opening; -1: not
  Openings openings_;
  bool fluid_cells_ = false;
  Frame frame_;
  std::vector<Outlet> outlets_;
  std::unique_ptr<coupling::ImplicitEnds> ends_;
  std::vector<const KnownPressure*> modelled_;  ///< of the places of ends_
  double start_s_ = 0, until_s_ = 0;            ///< of the running step
};

}  // namespace valsalva::flow_scene
