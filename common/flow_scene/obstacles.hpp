// The rigid bodies of a scene: [[obstacle]] as signed distances in the axes of the case, their prescribed
// motion, and the faces of the grid that they hold.
//
// Walls of the kind `staircase`: each obstacle is a held body of its own. `interpolated`: obstacles at rest
// are the wall of one level set (fluid/solids.hpp); moving ones stay staircases.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/case.hpp"
#include "flow_scene/expression.hpp"
#include "flow_scene/frame.hpp"
#include "fluid/flow.hpp"
#include "fluid/wall_force.hpp"

namespace valsalva::flow_scene {

class Obstacles {
 public:
  struct Obstacle {
    std::string name, what;
    fluid::Distance distance;  ///< negative in the solid; at displacement 0, axes of the case
    bool part = false;
    double reach = 1e300;  ///< of the solid from its centre
    Vec3 centre = Vec3::Zero();
    std::shared_ptr<VectorExpression> displacement;
    std::shared_ptr<Expression> turn_deg;
    Vec3 turn_axis = Vec3::UnitZ(), turn_point = Vec3::Zero();
    int body = -1;                           ///< of the flow's solids; 0: in its wall
    int sharp = -1;                          ///< its faces near deformable bodies, where it is in the wall
    std::shared_ptr<fluid::WallForce> wall;  ///< of an interpolated wall

    bool moves() const { return displacement || turn_deg; }
    Vec3 shift(double time_s) const;
    double angle(double time_s) const;  ///< rad
    /// Where x, at time_s, lies in the shape at displacement 0.
    Vec3 to_rest(const Vec3& x, double time_s) const;
    /// The wall's point nearest to x, and its normal into the fluid; h: over which the distance is
    /// differentiated. InputError with `what` when none is found.
    fluid::WallPoint wall_near(const Vec3& x, double time_s, double h, const std::string& what) const;
    double distance_at(const Vec3& x, double time_s) const { return distance(to_rest(x, time_s)); }
  };

  /// h: cell size, for level sets of files. InputError that names the entry.
  Obstacles(const Case& scene, double h);

  const std::vector<Obstacle>& all() const { return obstacles_; }
  const Obstacle& find(const std::string& name, const std::string& what) const;
  bool move() const;

  /// Before anything else: the bodies and walls in the flow, as they stand at time_s. Faces of interpolated
  /// walls within three cells of sharp_at (axes of the case) are staircases: docs/decisions/flow-bodies.md.
  void place(fluid::Flow& flow, const Frame& frame, double time_s, const Points& sharp_at = {});
  /// Interpolated walls get their points for load_on; otherwise nothing to do.
  void prepare_loads(const fluid::Flow& flow, const Frame& frame, const std::string& name);
  /// Moving bodies to where they are at time_s.
  void update(fluid::Flow& flow, const Frame& frame, double time_s);
  /// Of moving bodies now, sum of the components, mm/s; a bound.
  double largest_speed(const fluid::Flow& flow) const;
  /// Over all updates: the largest change of a moving obstacle's velocity from one to the next over its own
  /// largest velocity; of all obstacles the largest. Forces are late by about three quarters of that.
  double largest_change_of_velocity() const;
  const std::vector<double>& save() const { return largest_; }
  void restore(const std::vector<double>& saved);
  /// Of the fluid on an obstacle over the last step: micronewton and micronewton mm about a point, axes of
  /// the case (collective). By the momentum that its faces take, less what its own motion asks of the fluid
  /// that it covers; on an interpolated wall by its tractions.
  struct Load {
    Vec3 force, moment;
  };
  Load load_on(fluid::Flow& flow, const Frame& frame, const Obstacle& obstacle, const Vec3& about,
               double time_s) const;

 private:
  void sharpen(fluid::Flow& flow, const Frame& frame, const Points& at);
  void mark(fluid::Flow& flow, const Frame& frame, const Obstacle& obstacle, double time_s) const;

  std::vector<Obstacle> obstacles_;
  double difference_s_;          ///< time difference for velocities
  std::vector<double> largest_;  ///< of each obstacle by turns: change of velocity, velocity
};

}  // namespace valsalva::flow_scene
