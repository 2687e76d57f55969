// The structure of a scene, which stands in the axes of the case, as the solver sees it in its own
// (frame.hpp): positions, forces and velocities are turned where the two meet.
#pragma once

#include <memory>

#include "coupling/immersed_structure.hpp"
#include "flow_scene/frame.hpp"

namespace valsalva::flow_scene {

class TurnedBody : public coupling::ImmersedBody {
 public:
  /// sampling: in the solver's axes. low, high: the room of the nodes that couple, axes of the case; nothing
  /// in directions without bound. couples: one a node.
  TurnedBody(std::unique_ptr<coupling::ImmersedStructure> body, const Frame& frame,
             coupling::Sampling sampling, const Vec3& low, const Vec3& high,
             std::vector<std::uint8_t> couples);

  coupling::ImmersedStructure& structure() { return *body_; }
  const coupling::ImmersedStructure& structure() const { return *body_; }

  const Points& x() const override { return x_; }
  void set_x(Points x) override;
  const Points& coupling_points() const override { return sampling_.points(); }
  const coupling::Sampling* sampling() const override { return &sampling_; }
  std::size_t unknowns() const override { return body_->unknowns(); }
  std::vector<double> own_masses() const override { return body_->own_masses(); }
  void begin_step(double dt_s, const Points& last_velocity, double lead) override;
  double lead() const override { return body_->lead(); }
  double least_lead() const override { return body_->least_lead(); }
  void forces(Points& out) override;
  void update_tangent() override { body_->update_tangent(); }
  void tangent_product(const Points& direction, Points& out) const override;
  /// NumericalFailure, too, that names a node that has left its room.
  void move(Points& velocity, double dt_s) override;
  coupling::EdgeStretch edge_stretch(const Points& since) const override;
  double stiffening(double strain) const override { return body_->stiffening(strain); }
  std::map<std::string, state::Array> save() const override { return body_->save(); }
  void load(const state::State& state) override { body_->load(state); }

 private:
  Points to_case(const Points& p) const;
  void to_solver(Points& p) const;
  void moved();

  std::unique_ptr<coupling::ImmersedStructure> body_;
  Frame frame_;
  coupling::Sampling sampling_;
  Vec3 low_, high_;
  std::vector<std::uint8_t> couples_;
  Points x_;
};

}  // namespace valsalva::flow_scene
