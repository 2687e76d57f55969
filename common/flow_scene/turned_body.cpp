#include "flow_scene/turned_body.hpp"

#include "core/errors.hpp"

namespace valsalva::flow_scene {

TurnedBody::TurnedBody(std::unique_ptr<coupling::ImmersedStructure> body, const Frame& frame,
                       coupling::Sampling sampling, const Vec3& low, const Vec3& high,
                       std::vector<std::uint8_t> couples)
    : body_(std::move(body)),
      frame_(frame),
      sampling_(std::move(sampling)),
      low_(low),
      high_(high),
      couples_(std::move(couples)) {
  moved();
}

Points TurnedBody::to_case(const Points& p) const {
  Points out;
  out.reserve(p.size());
  for (const Vec3& v : p) out.push_back(frame_.to_case(v));
  return out;
}

void TurnedBody::to_solver(Points& p) const {
  if (frame_.shift == 0) return;
  for (Vec3& v : p) v = frame_.to_solver(v);
}

void TurnedBody::moved() {
  x_ = body_->x();
  to_solver(x_);
  sampling_.locate(x_);
}

void TurnedBody::set_x(Points x) {
  body_->set_x(to_case(x));
  moved();
}

void TurnedBody::begin_step(double dt_s, const Points& last_velocity, double lead) {
  body_->begin_step(dt_s, to_case(last_velocity), lead);
}

void TurnedBody::forces(Points& out) {
  body_->forces(out);
  to_solver(out);
}

void TurnedBody::tangent_product(const Points& direction, Points& out) const {
  body_->tangent_product(to_case(direction), out);
  to_solver(out);
}

void TurnedBody::move(Points& velocity, double dt_s) {
  velocity = to_case(velocity);
  body_->move(velocity, dt_s);
  to_solver(velocity);
  const Points& x = body_->x();
  for (std::size_t a = 0; a < x.size(); ++a) {
    const bool inside = (x[a].array() >= low_.array()).all() && (x[a].array() <= high_.array()).all();
    if (couples_[a] && !inside)
      throw NumericalFailure(
          "coupling: {} at ({:.4g}, {:.4g}, {:.4g}) mm is outside the fluid's box, or less than two cells "
          "from an open side or an inflow; make the box larger",
          body_->system().describe(static_cast<int>(a)), x[a].x(), x[a].y(), x[a].z());
  }
  moved();
}

coupling::EdgeStretch TurnedBody::edge_stretch(const Points& since) const {
  return body_->edge_stretch(to_case(since));
}

}  // namespace valsalva::flow_scene
