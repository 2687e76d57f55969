// The six sides of the box: [[boundary]] as the flow's boundaries, and what they prescribe over time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "circulation/windkessel.hpp"
#include "core/case.hpp"
#include "flow_scene/expression.hpp"
#include "flow_scene/frame.hpp"
#include "fluid/flow.hpp"

namespace valsalva::flow_scene {

struct SideOfBox {
  int axis = 0;  ///< of the case
  int side = 0;  ///< 0 low, 1 high
};
/// Of "x_low" and so on; InputError with `what`.
SideOfBox side_from(const std::string& name, const std::string& what);

/// A factor over time: a table (in the file or beside it), an expression, or 1.
class Factor {
 public:
  Factor(const Case& scene, const Case& entry, const std::string& what);
  double operator()(double time_s) const;

 private:
  std::vector<double> time_, value_;
  double period_s_ = 0;
  std::optional<Expression> expression_;
};

class Sides {
 public:
  /// InputError that names the entry: a side twice, open sides along two axes, profiles without speed ...
  explicit Sides(const Case& scene);

  const Frame& frame() const { return frame_; }
  bool periodic(int case_axis) const { return kind_[case_axis][0] == fluid::Side::periodic; }
  bool slip(int case_axis) const {
    return kind_[case_axis][0] == fluid::Side::slip && kind_[case_axis][1] == fluid::Side::slip;
  }
  /// May the box be a part of a cell longer there?
  bool ends_anywhere(int case_axis) const {
    return kind_[case_axis][1] == fluid::Side::open || kind_[case_axis][1] == fluid::Side::slip;
  }
  /// Does a wall there have a velocity?
  bool moves(int case_axis, int side) const {
    if (entry_of_[case_axis][side] < 0) return false;
    const VectorExpression& velocity = *entries_[entry_of_[case_axis][side]].velocity;
    return velocity.changes() || velocity.varies() || !velocity(Vec3::Zero(), 0).isZero();
  }
  bool has_outflow() const;
  /// In the solver's axes.
  fluid::Boundaries boundaries() const;

  /// Sets everything that is prescribed, as it is at time_s. The flow's obstacles must stand. InputError when
  /// a box without outflow is asked to take in more than it lets out.
  void set(fluid::Flow& flow, double time_s);
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
    double radius = 0, speed = 0, mean = 0, flow_mm3 = 0, pressure = 0;
    std::shared_ptr<Factor> factor;
    std::optional<circulation::WindkesselParameters> windkessel;
    double resistance = 0;  ///< Pa s/mm3, without compliance
  };
  struct Outlet {
    int end = 0;
    const Entry* entry = nullptr;
    std::unique_ptr<circulation::Terminal> terminal;  ///< none: the pressure is prescribed
  };
  Entry read(const Case& scene, const Case& entry) const;
  void set_inflow(fluid::Flow& flow, const Entry& entry, const SideOfBox& side, double time_s) const;
  void balance(fluid::Flow& flow) const;

  std::vector<Entry> entries_;
  std::array<std::array<fluid::Side, 2>, 3> kind_{};  ///< in the axes of the case
  std::array<std::array<int, 2>, 3> entry_of_{};      ///< -1: none
  Frame frame_;
  std::vector<Outlet> outlets_;
};

}  // namespace valsalva::flow_scene
