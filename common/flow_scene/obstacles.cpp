#include "flow_scene/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "assembly/entry.hpp"
#include "assembly/mesh_file.hpp"
#include "flow_scene/shapes.hpp"
#include "geometry/level_set.hpp"
#include "geometry/surface.hpp"

namespace valsalva::flow_scene {

namespace {

using assembly::Entry;
using fluid::Distance;
using Obstacle = Obstacles::Obstacle;

double positive_of(const Entry& e, const std::string& key) {
  if (!(e.real(key) > 0)) e.fail(fmt::format("{} is {}; expected a value above 0", key, e.real(key)));
  return e.real(key);
}

Vec3 size_of(const Entry& e) {
  if (e.reals("size_mm").size() != 3)
    e.fail(fmt::format("size_mm has {} entries; expected three", e.reals("size_mm").size()));
  return e.vector("size_mm");
}

/// Rows: the shape's own directions, the third along the axis.
Mat3 directions_of(const Entry& e) {
  const Vec3 axis = e.direction("axis");
  Vec3 first = e.vector("direction");
  first -= axis.dot(first) * axis;
  if (!(first.norm() > 1e-9)) first = axis.unitOrthogonal();
  first.normalize();
  Mat3 out;
  out.row(0) = first;
  out.row(1) = axis.cross(first);
  out.row(2) = axis;
  return out;
}

Distance revolution(const Entry& e, const std::function<Vec3(const Vec3&)>& own, bool endless) {
  const auto& table = e.reals("profile_mm");
  if (table.size() < 4 || table.size() % 2 != 0)
    e.fail(fmt::format("profile_mm has {} entries; expected s and radius by turns, two stations at least",
                       table.size()));
  std::vector<double> s, r;
  for (std::size_t i = 0; i < table.size(); i += 2) {
    if (i > 0 && table[i] < table[i - 2])
      e.fail(fmt::format("profile_mm: s = {} after {}; expected ascending values", table[i], table[i - 2]));
    if (table[i + 1] < 0) e.fail(fmt::format("profile_mm: a radius of {}", table[i + 1]));
    s.push_back(table[i]);
    r.push_back(table[i + 1]);
  }
  const auto body = std::make_shared<Revolution>(s, r, endless);
  return [body, own](const Vec3& x) { return body->distance(own(x)); };
}

Distance of_file(const Case& scene, const Entry& e, double h, Obstacle& out) {
  if (e.text("file").empty()) e.fail("file is missing; expected a closed surface");
  const auto path = scene.resolve(e.text("file"));
  const assembly::BodyMesh mesh =
      assembly::read_mesh(path, assembly::Elements::triangles, "", e.real("scale_to_mm"));
  const geometry::TriMesh surface{mesh.points, mesh.triangles};
  if (!geometry::border_loops(surface).empty())
    e.fail(fmt::format("file '{}' is not a closed surface", path.string()));
  if (!(geometry::enclosed_volume(surface) > 0))
    e.fail(
        fmt::format("file '{}' has its normals inwards; expected a closed, outward surface", path.string()));
  Vec3 low = surface.points.front(), high = low;
  for (const Vec3& p : surface.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  constexpr double most_samples = 2e8, margin = 8;
  const double spacing = e.real("spacing_mm") > 0 ? e.real("spacing_mm") : h;
  auto grid = std::make_shared<geometry::GridSdf>();
  grid->spacing = spacing;
  grid->origin = low - margin * spacing * Vec3::Ones();
  double samples = 1;
  for (int d = 0; d < 3; ++d) {
    grid->dimensions[d] = static_cast<int>((high[d] - low[d]) / spacing + 2 * margin) + 2;
    samples *= grid->dimensions[d];
  }
  if (samples > most_samples)
    e.fail(fmt::format("spacing_mm {} gives {:.3g} samples; expected at most {:.0e}", spacing, samples,
                       most_samples));
  *grid = geometry::signed_distance(surface, *grid);
  out.centre = 0.5 * (low + high);
  out.reach = 0.5 * (high - low).norm();
  return [grid](const Vec3& x) { return grid->value(x); };
}

Distance combined(const Entry& e, const std::string& kind, const std::vector<Obstacle>& before) {
  std::vector<Distance> parts;
  for (const std::string& name : e.texts("of")) {
    const auto at =
        std::find_if(before.begin(), before.end(), [&](const Obstacle& o) { return o.name == name; });
    if (at == before.end()) e.fail(fmt::format("of: '{}' is no obstacle that stands above this one", name));
    if (at->moves()) e.fail(fmt::format("of: '{}' moves; let the whole move instead", name));
    parts.push_back(at->distance);
  }
  if (parts.empty()) e.fail("of is empty; expected names of obstacles");
  return [parts, kind](const Vec3& x) {
    double d = parts[0](x);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      if (kind == "union") d = std::min(d, parts[i](x));
      if (kind == "intersection") d = std::max(d, parts[i](x));
      if (kind == "difference") d = std::max(d, -parts[i](x));
    }
    return d;
  };
}

Distance shape_of(const Case& scene, const Entry& e, double h, const std::vector<Obstacle>& before,
                  Obstacle& out) {
  const std::string& shape = e.text("shape");
  const Vec3 centre = e.vector("centre_mm");
  const Mat3 turn = directions_of(e);
  const auto own = [centre, turn](const Vec3& x) -> Vec3 { return turn * (x - centre); };
  out.centre = centre;
  if (shape == "sphere") {
    const double r = out.reach = positive_of(e, "radius_mm");
    return [=](const Vec3& x) { return (x - centre).norm() - r; };
  }
  if (shape == "ellipsoid") {
    const Vec3 half = 0.5 * size_of(e);
    out.reach = half.maxCoeff();
    return [=](const Vec3& x) { return distance_to_ellipsoid(own(x), half); };
  }
  if (shape == "cylinder") {
    const double r = positive_of(e, "radius_mm"), length = e.real("length_mm");
    if (length > 0) out.reach = std::hypot(r, 0.5 * length);
    return [=](const Vec3& x) { return distance_to_cylinder(own(x), r, length); };
  }
  if (shape == "box") {
    const Vec3 half = 0.5 * size_of(e);
    out.reach = half.norm();
    return [=](const Vec3& x) { return distance_to_box(own(x), half); };
  }
  if (shape == "half_space") return [=](const Vec3& x) { return own(x)[2]; };
  if (shape == "torus") {
    const double r = positive_of(e, "radius_mm"), tube = positive_of(e, "tube_mm");
    out.reach = r + tube;
    return [=](const Vec3& x) { return distance_to_torus(own(x), r, tube); };
  }
  if (shape == "revolution") return revolution(e, own, e.text("fluid") == "inside");
  if (shape == "expression") {
    const auto level = std::make_shared<Expression>(e.text("distance"), e.what() + ", distance");
    return [level](const Vec3& x) { return (*level)(x, 0); };
  }
  if (shape == "file") return of_file(scene, e, h, out);
  return combined(e, shape, before);
}

Obstacle read(const Case& scene, const Case& entry, double h, const std::vector<Obstacle>& before) {
  const Entry e(scene, "obstacle", entry);
  Obstacle out;
  out.name = e.text("name");
  out.what = e.what();
  out.part = e.boolean("part");
  out.distance = shape_of(scene, e, h, before, out);
  if (e.text("fluid") == "inside") {
    out.distance = [solid = out.distance](const Vec3& x) { return -solid(x); };
    out.reach = 1e300;
  }
  if (!e.texts("displacement").empty())
    out.displacement =
        std::make_shared<VectorExpression>(e.texts("displacement"), e.what() + ", displacement");
  if (!e.text("turn_deg").empty())
    out.turn_deg = std::make_shared<Expression>(e.text("turn_deg"), e.what() + ", turn_deg");
  if ((out.displacement && out.displacement->varies()) || (out.turn_deg && out.turn_deg->varies()))
    e.fail("the motion has x, y or z; expected expressions of t");
  out.turn_axis = e.direction("turn_axis");
  out.turn_point = e.vector("turn_point_mm");
  return out;
}

}  // namespace

Vec3 Obstacles::Obstacle::shift(double time_s) const {
  return displacement ? (*displacement)(Vec3::Zero(), time_s) : Vec3(Vec3::Zero());
}

double Obstacles::Obstacle::angle(double time_s) const {
  return turn_deg ? (*turn_deg)(Vec3::Zero(), time_s) * std::numbers::pi / 180 : 0;
}

Vec3 Obstacles::Obstacle::to_rest(const Vec3& x, double time_s) const {
  if (!moves()) return x;
  const Vec3 arm = x - shift(time_s) - turn_point;
  return turn_point + Eigen::AngleAxisd(-angle(time_s), turn_axis) * arm;
}

fluid::WallPoint Obstacles::Obstacle::wall_near(const Vec3& x, double time_s, double h,
                                                const std::string& what_for) const {
  Vec3 at = x, slope = Vec3::Zero();
  for (int iteration = 0; iteration < 20; ++iteration) {
    for (int e = 0; e < 3; ++e) {
      const Vec3 to = 0.25 * h * Vec3::Unit(e);
      slope[e] = (distance_at(at + to, time_s) - distance_at(at - to, time_s)) / (0.5 * h);
    }
    const double d = distance_at(at, time_s);
    if (!(slope.norm() > 0.1)) break;
    if (std::abs(d) < 1e-6 * h) return {at, slope.normalized()};
    at -= d / slope.squaredNorm() * slope;
  }
  throw InputError("{}: no wall of '{}' is found from point_mm; put it next to the wall", what_for, name);
}

Obstacles::Obstacles(const Case& scene, double h) : difference_s_(1e-6 * scene.real("fluid.end_s")) {
  for (const Case& entry : scene.entries("obstacle")) obstacles_.push_back(read(scene, entry, h, obstacles_));
}

const Obstacles::Obstacle& Obstacles::find(const std::string& name, const std::string& what) const {
  for (const Obstacle& obstacle : obstacles_)
    if (obstacle.name == name && !obstacle.part) return obstacle;
  throw InputError("{}: of = '{}' is no obstacle (parts do not count); expected the name of an [[obstacle]]",
                   what, name);
}

bool Obstacles::move() const {
  return std::any_of(obstacles_.begin(), obstacles_.end(),
                     [](const Obstacle& o) { return o.moves() && !o.part; });
}

void Obstacles::place(fluid::Flow& flow, const Frame& frame, double time_s, const Points& sharp_at) {
  largest_.assign(2 * obstacles_.size(), 0.0);
  std::vector<Distance> walls;
  for (Obstacle& obstacle : obstacles_) {
    if (obstacle.part) continue;
    if (flow.solids().interpolated() && !obstacle.moves()) {
      walls.push_back(obstacle.distance);
      obstacle.body = fluid::Solids::wall;
    } else {
      obstacle.body = flow.solids().add_body(obstacle.name);
      mark(flow, frame, obstacle, time_s);
    }
  }
  if (walls.empty()) return;
  if (!sharp_at.empty()) sharpen(flow, frame, sharp_at);
  flow.solids().set_lumen([&](const Vec3& x) {
    const Vec3 here = frame.to_case(x);
    double in_solid = -1e300;
    for (const Distance& wall : walls) in_solid = std::max(in_solid, -wall(here));
    return in_solid;
  });
}

void Obstacles::sharpen(fluid::Flow& flow, const Frame& frame, const Points& at) {
  constexpr int reach = 3;  // cells
  const fluid::Grid& grid = flow.grid();
  using Cell = std::array<int, 3>;
  const auto cell_of = [&](const Vec3& x) {
    const Vec3 place = (x - grid.origin) / grid.h;
    return Cell{static_cast<int>(std::floor(place[0])), static_cast<int>(std::floor(place[1])),
                static_cast<int>(std::floor(place[2]))};
  };
  std::set<Cell> near;
  for (Obstacle& obstacle : obstacles_) {
    if (obstacle.part || obstacle.body != fluid::Solids::wall) continue;
    near.clear();
    for (const Vec3& x : at) {
      if (obstacle.distance(x) > (reach + 1) * grid.h) continue;
      const Cell centre = cell_of(frame.to_solver(x));
      for (int c = -reach; c <= reach; ++c)
        for (int b = -reach; b <= reach; ++b)
          for (int a = -reach; a <= reach; ++a) near.insert({centre[0] + a, centre[1] + b, centre[2] + c});
    }
    if (near.empty()) continue;
    obstacle.sharp = flow.solids().add_body(obstacle.name + " at bodies");
    const Vec3 extent = grid.h * Vec3::Ones();
    flow.solids().mark_inside(
        obstacle.sharp,
        [&](const Vec3& x) { return near.contains(cell_of(x)) ? obstacle.distance(frame.to_case(x)) : 1.0; },
        grid.low() - extent, grid.high() + extent);
  }
}

void Obstacles::mark(fluid::Flow& flow, const Frame& frame, const Obstacle& obstacle, double time_s) const {
  const Vec3 extent = flow.grid().h * Vec3::Ones();
  Vec3 low = flow.grid().low() - extent, high = flow.grid().high() + extent;
  if (obstacle.reach < 1e299) {
    // The centre turns and shifts with the shape.
    const Vec3 arm = obstacle.centre - obstacle.turn_point;
    const Vec3 centre = obstacle.shift(time_s) + obstacle.turn_point +
                        Eigen::AngleAxisd(obstacle.angle(time_s), obstacle.turn_axis) * arm;
    const Vec3 reach = (obstacle.reach + flow.grid().h) * Vec3::Ones();
    low = low.cwiseMax(frame.to_solver(centre) - reach);
    high = high.cwiseMin(frame.to_solver(centre) + reach);
  }
  flow.solids().mark_inside(
      obstacle.body, [&](const Vec3& x) { return obstacle.distance_at(frame.to_case(x), time_s); }, low,
      high);
  if (!obstacle.moves()) return;
  const double before = time_s - difference_s_, after = time_s + difference_s_, span = 2 * difference_s_;
  fluid::RigidMotion motion;
  motion.velocity = frame.to_solver((obstacle.shift(after) - obstacle.shift(before)) / span);
  motion.rate = frame.to_solver((obstacle.angle(after) - obstacle.angle(before)) / span * obstacle.turn_axis);
  motion.centre = frame.to_solver(obstacle.turn_point + obstacle.shift(time_s));
  flow.solids().set_motion(obstacle.body, motion);
}

void Obstacles::update(fluid::Flow& flow, const Frame& frame, double time_s) {
  for (const Obstacle& obstacle : obstacles_) {
    if (obstacle.part || !obstacle.moves()) continue;
    flow.solids().clear_body(obstacle.body);
  }
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const Obstacle& obstacle = obstacles_[i];
    if (obstacle.part || !obstacle.moves()) continue;
    const fluid::RigidMotion before = flow.solids().motion(obstacle.body);
    mark(flow, frame, obstacle, time_s);
    const fluid::RigidMotion& now = flow.solids().motion(obstacle.body);
    const double arm = std::min(obstacle.reach, (flow.grid().high() - flow.grid().low()).norm());
    const auto size = [&](const Vec3& velocity, const Vec3& rate) {
      return velocity.norm() + arm * rate.norm();
    };
    largest_[2 * i] = std::max(largest_[2 * i], size(now.velocity - before.velocity, now.rate - before.rate));
    largest_[2 * i + 1] = std::max(largest_[2 * i + 1], size(now.velocity, now.rate));
  }
}

double Obstacles::largest_change_of_velocity() const {
  double most = 0;
  for (std::size_t i = 0; i < largest_.size(); i += 2)
    if (largest_[i + 1] > 0) most = std::max(most, largest_[i] / largest_[i + 1]);
  return most;
}

void Obstacles::restore(const std::vector<double>& saved) {
  if (saved.size() != 2 * obstacles_.size())
    throw InputError("scene/obstacles has {} entries, expected {}", saved.size(), 2 * obstacles_.size());
  largest_ = saved;
}

double Obstacles::largest_speed(const fluid::Flow& flow) const {
  double largest = 0;
  const Vec3 low = flow.grid().low(), high = flow.grid().high();
  for (const Obstacle& obstacle : obstacles_) {
    if (obstacle.part || !obstacle.moves()) continue;
    const fluid::RigidMotion& motion = flow.solids().motion(obstacle.body);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 x;
      for (int e = 0; e < 3; ++e) x[e] = (corner >> e & 1) ? high[e] : low[e];
      if (obstacle.reach < 1e299) {
        const double most = obstacle.reach + (obstacle.centre - obstacle.turn_point).norm();
        const Vec3 arm = x - motion.centre;
        if (arm.norm() > most) x = motion.centre + most / arm.norm() * arm;
      }
      largest = std::max(largest, motion.at(x).lpNorm<1>());
    }
  }
  return largest;
}

void Obstacles::prepare_loads(const fluid::Flow& flow, const Frame& frame, const std::string& name) {
  for (Obstacle& obstacle : obstacles_) {
    if (obstacle.name != name || obstacle.body != fluid::Solids::wall) continue;
    obstacle.wall = std::make_shared<fluid::WallForce>(
        flow.grid(), [&](const Vec3& x) { return obstacle.distance(frame.to_case(x)); });
  }
}

Obstacles::Load Obstacles::load_on(fluid::Flow& flow, const Frame& frame, const Obstacle& obstacle,
                                   const Vec3& about, double time_s) const {
  const Vec3 place = frame.to_solver(about);
  if (obstacle.wall) {
    const fluid::WallForce::Sum sum = obstacle.wall->of(flow, place);
    const bool alone = std::count_if(obstacles_.begin(), obstacles_.end(),
                                     [](const Obstacle& o) { return o.body == fluid::Solids::wall; }) == 1;
    Vec3 force = alone ? flow.solids().force_on(fluid::Solids::wall) : sum.force;
    if (alone && obstacle.sharp >= 0) force += flow.solids().force_on(obstacle.sharp);
    return {frame.to_case(force), frame.to_case(sum.moment)};
  }
  Load load{frame.to_case(flow.solids().force_on(obstacle.body)),
            frame.to_case(flow.solids().moment_on(obstacle.body, place))};
  if (obstacle.moves()) {
    const double apart = 100 * difference_s_;
    const Vec3 centre = obstacle.turn_point + obstacle.shift(time_s);
    // Where what is at x now is at another time.
    const auto at = [&](const Vec3& x, double other_s) -> Vec3 {
      const double turned = obstacle.angle(other_s) - obstacle.angle(time_s);
      return obstacle.turn_point + obstacle.shift(other_s) +
             Eigen::AngleAxisd(turned, obstacle.turn_axis) * (x - centre);
    };
    const auto acceleration = [&](const Vec3& solver_x) {
      const Vec3 x = frame.to_case(solver_x);
      return frame.to_solver((at(x, time_s + apart) - 2 * x + at(x, time_s - apart)) / (apart * apart));
    };
    const auto [force, moment] = flow.solids().inertia(obstacle.body, acceleration, place);
    load.force += frame.to_case(force);
    load.moment += frame.to_case(moment);
  }
  return load;
}

}  // namespace valsalva::flow_scene
