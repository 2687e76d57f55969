#include "flow_scene/bodies.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "assembly/entry.hpp"
#include "core/log.hpp"

namespace valsalva::flow_scene {

namespace {

using assembly::BuiltBody;
using assembly::Kind;
using coupling::Cell;

constexpr double room_cells = 2, round_off = 1e-9;                       // coupling/transfer.hpp
constexpr double longest_for_nodes = 0.75;                               // of a cell
constexpr double shortest_for_solids = 0.8;                              // of a cell
constexpr double tie_limit_over_elastic = 4, tie_limit_over_flow = 1.3;  // so that ties cost no step

std::vector<Cell> cells_of(const BuiltBody& body) {
  switch (body.kind) {
    case Kind::solid:
      return coupling::cells_of(body.solid->mesh(), body.at.offset);
    case Kind::shell:
      return coupling::cells_of(body.mesh.triangles, body.at.offset);
    case Kind::beams:
      return coupling::cells_of(body.mesh.lines, body.at.offset);
    case Kind::rigid:
      break;
  }
  return {};
}

double longest_edge(const std::vector<Cell>& cells, const Points& x) {
  double longest = 0;
  for (const Edge& e : coupling::edges_of(cells)) longest = std::max(longest, (x[e[0]] - x[e[1]]).norm());
  return longest;
}

/// Of the edges that can move, those shorter than `length`: their share.
double share_of_short_edges(const std::vector<Cell>& cells, const structure::System& system, double length) {
  double all = 0, below = 0;
  for (const auto& [a, b] : coupling::edges_of(cells)) {
    const Vec3 edge = system.state.x[a] - system.state.x[b];
    if ((edge - system.held_directions(a) * edge).norm() < 0.1 * edge.norm() &&
        (edge - system.held_directions(b) * edge).norm() < 0.1 * edge.norm())
      continue;  // across a plane flow
    ++all;
    below += edge.norm() < length ? 1 : 0;
  }
  return all > 0 ? below / all : 0;
}

bool is_zero(const VectorExpression& f) {
  return !f.changes() && !f.varies() && f(Vec3::Zero(), 0).isZero();
}

/// Takes off what the fluid's body force does to the fluid inside the bodies.
class DisplacedForce : public structure::ForceTerm {
 public:
  DisplacedForce(VectorExpression force, std::vector<double> volume_mm3)
      : force_(std::move(force)), volume_(std::move(volume_mm3)) {}
  std::string name() const override { return "body force on the fluid that bodies displace"; }
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override {
    for (std::size_t a = 0; a < volume_.size(); ++a)
      if (volume_[a] > 0) out.force[a] -= volume_[a] * force_(now.x[a], now.time_s);
    return 0;
  }
  void add_stiffness_bound(const structure::Configuration&, structure::StiffnessBound&) const override {}

 private:
  VectorExpression force_;
  std::vector<double> volume_;
};

void refuse_without_bodies(const Case& scene) {
  for (const char* table : {"nodes", "support", "load", "tie", "contact_pair", "probe"})
    if (scene.has(table))
      throw InputError(
          "{}: found [[{}]] in a scene of fluid without [[body]]; expected bodies, or none of it{}",
          scene.file().string(), table,
          std::string(table) == "probe" ? " (what is measured of the fluid is [[flow_probe]])" : "");
}

void refuse_what_does_not_go(const Case& scene) {
  const std::string file = scene.file().string();
  if (scene.has("dynamics"))
    throw InputError(
        "{}: [dynamics] is for scenes without fluid; with fluid.box_mm the run ends at fluid.end_s, rows are "
        "fluid.history_rows, the step is found ([coupling])",
        file);
  if (scene.text("fluid.time_scheme") == "rk3")
    throw InputError("{}: fluid.time_scheme = \"rk3\" with [[body]]; expected \"ab2\"", file);
  if (scene.integer("fluid.order") != 2)
    throw InputError("{}: fluid.order = {} with [[body]]; expected 2", file, scene.integer("fluid.order"));
  for (const Case& entry : scene.entries("body")) {
    const std::string what = fmt::format("{}: [[body]] '{}'", file, entry.text("body.name"));
    if (entry.text("body.kind") == "rigid" && entry.text("body.motion") == "free")
      throw InputError(
          "{}: kind = \"rigid\" with motion = \"free\" in a fluid; expected a stiff solid, or an "
          "[[obstacle]] "
          "whose motion is known",
          what);
    for (const char* key : {"body.velocity_mm_per_s", "body.spin_rad_per_s"}) {
      const auto& v = entry.reals(key);
      if (v[0] != 0 || v[1] != 0 || v[2] != 0)
        throw InputError("{}: {} is set; in a fluid bodies start with its velocity: set fluid.velocity there",
                         what, std::string(key).substr(5));
    }
  }
}

}  // namespace

std::unique_ptr<Bodies> Bodies::of(const Case& scene, const Obstacles& obstacles) {
  if (!scene.has("body")) {
    refuse_without_bodies(scene);
    return nullptr;
  }
  refuse_what_does_not_go(scene);
  std::unique_ptr<Bodies> bodies(new Bodies(scene));
  for (const auto& obstacle : obstacles.all())
    if (bodies->has(obstacle.name))
      throw InputError("{}: [[body]] '{}' and [[obstacle]] '{}' have one name; rename one of them",
                       scene.file().string(), obstacle.name, obstacle.name);
  return bodies;
}

Bodies::Bodies(const Case& scene)
    : file_(scene.file().string()), scene_(assembly::compose(scene, {}, scene.real("fluid.end_s"))) {
  if (std::all_of(scene_.bodies.begin(), scene_.bodies.end(),
                  [](const BuiltBody& b) { return b.kind == Kind::rigid; }))
    throw InputError(
        "{}: all [[body]] entries are rigid; the fluid meets shells, solids and beams, and rigid bodies as "
        "[[obstacle]]",
        file_);
  probes_ = std::make_unique<assembly::Probes>(scene, scene_);
  drive_ = std::make_unique<assembly::Drive>(scene_);
  displace(scene);
  rate_.resize(scene_.bodies.size());
  VectorExpression force(scene.texts("fluid.body_force_Pa_per_mm"), file_ + ": fluid.body_force_Pa_per_mm");
  if (is_zero(force)) return;
  std::vector<double> volume(scene_.system->nodes(), 0.0);
  for (const BuiltBody& body : scene_.bodies)
    for (int a = body.at.begin(); a < body.at.end(); ++a)
      if (body.kind != Kind::rigid) volume[a] = scene_.system->mass(a) / body.density;
  displaced_ = std::make_shared<DisplacedForce>(std::move(force), std::move(volume));
}

void Bodies::displace(const Case& scene) {
  const auto& entries = scene.entries("body");
  for (std::size_t b = 0; b < entries.size(); ++b) {
    const auto& texts = entries[b].texts("body.start_displacement");
    if (texts.empty()) continue;
    const BuiltBody& body = scene_.bodies[b];
    const std::string what = fmt::format("{}: [[body]] '{}': start_displacement", file_, body.name);
    const VectorExpression by(texts, what);
    if (by.changes()) throw InputError("{} has t; expected expressions of x, y, z", what);
    for (int a = body.at.begin(); a < body.at.end(); ++a) {
      Vec3& x = scene_.system->state.x[a];
      x += by(x, 0);
      if (!x.allFinite()) throw InputError("{} is not finite at node {}", what, a - body.at.offset);
    }
  }
}

bool Bodies::has(const std::string& name) const {
  return std::any_of(scene_.bodies.begin(), scene_.bodies.end(),
                     [&](const BuiltBody& b) { return b.name == name && b.kind != Kind::rigid; });
}

Points Bodies::places() const {
  Points out;
  for (const BuiltBody& body : scene_.bodies)
    if (body.kind != Kind::rigid)
      for (const Vec3& x : body.places(scene_.system->state)) out.push_back(x);
  return out;
}

void Bodies::immerse(const Case& scene, fluid::Flow& flow, const Frame& frame, double cfl, double flow_step_s,
                     double smallest_s, const coupling::Surroundings& beyond) {
  structure::System& system = *scene_.system;
  const double h = flow.grid().h, fluid_density = flow.parameters().density;
  const std::string& way = scene.text("coupling.points");
  coupling::ImmersedStructureSettings settings;
  std::vector<Cell> sampled;
  std::vector<std::uint8_t> left_out(system.nodes(), 0);
  Points reference = system.state.x;
  for (const BuiltBody& body : scene_.bodies) {
    std::copy(body.mesh.points.begin(), body.mesh.points.end(), reference.begin() + body.at.offset);
    const std::vector<Cell> cells = cells_of(body);
    settings.cells.insert(settings.cells.end(), cells.begin(), cells.end());
    const double longest = longest_edge(cells, system.state.x);
    const bool quadrature = way == "quadrature" ||
                            (way == "auto" && (body.kind == Kind::solid || longest > longest_for_nodes * h));
    if (quadrature && body.kind != Kind::rigid) sampled.insert(sampled.end(), cells.begin(), cells.end());
    for (int a = body.at.begin(); a < body.at.end(); ++a)
      left_out[a] = body.kind == Kind::rigid ||
                    (!quadrature && (system.held_directions(a) - Mat3::Identity()).norm() < 1e-12);
    if (body.kind == Kind::solid && share_of_short_edges(cells, system, shortest_for_solids * h) > 0.25)
      log::warn(
          "solid {} has nodes nearer than {} cells, whose motions the fluid cannot tell apart: its load may "
          "be wrong by half (docs/verification/flow-bodies.md); expected larger elements or a finer grid",
          body.name, shortest_for_solids);
    if (!quadrature && longest > h)
      log::warn("body {} couples at its nodes, and its longest edge is {:.3g} cells: fluid will pass through",
                body.name, longest / h);
    if (body.kind == Kind::rigid || !scene.boolean("coupling.excess_mass")) continue;
    try {
      coupling::add_excess_mass(system, body.at, body.density, fluid_density, settings.excess_mass_g);
    } catch (const InputError& error) {
      throw InputError(
          "{}: [[body]]: {}; or set coupling.excess_mass = false, and it is as inert as the fluid", file_,
          error.what());
    }
    density_ratio_ = std::max(density_ratio_, body.density / fluid_density);
  }
  couples_.assign(left_out.size(), 0);
  for (std::size_t a = 0; a < left_out.size(); ++a) couples_[a] = !left_out[a];
  check_places(flow, frame, beyond);

  // Bodies start with the velocity of the fluid.
  for (std::size_t a = 0; a < system.nodes(); ++a)
    if (couples_[a]) {
      const Vec3 u = frame.to_case(flow.velocity_at(Points{frame.to_solver(system.state.x[a])})[0]);
      system.state.v[a] = u - system.held_directions(static_cast<int>(a)) * u;
    }

  tie_rate_ = scene.real("coupling.tie_rate_per_s");
  settings.tie_rate_per_s = tie_rate_ > 0 ? tie_rate_ : 1e-9;  // hardly any, for auto_tie_rate
  settings.rotation_damping_per_s = scene.real("coupling.rotation_damping_per_s");
  settings.keep_volume = scene.boolean("coupling.keep_volume") &&
                         std::any_of(scene_.bodies.begin(), scene_.bodies.end(),
                                     [](const BuiltBody& body) { return body.kind == Kind::solid; });
  // Without their volumetric stiffness solids take steps that need the damping of the lead.
  settings.lead = settings.keep_volume && !scene.is_set("coupling.lead") ? coupling::step_lead
                                                                         : scene.real("coupling.lead");
  if (!scene_.body_contacts.empty())
    settings.guard = [this](structure::System& moving, double dt) {
      Points to = moving.state.x;
      for (std::size_t a = 0; a < to.size(); ++a) to[a] += dt * moving.state.v[a];
      for (const auto& contact : scene_.body_contacts)
        if (contact->allowed_motion(moving.state, to) < 1) slowed_ += contact->limit_velocities(moving, dt);
    };
  std::vector<std::shared_ptr<structure::ForceTerm>> terms = scene_.terms;
  if (displaced_) terms.push_back(displaced_);
  auto structure =
      std::make_unique<coupling::ImmersedStructure>(system, std::move(terms), reference, settings);
  Points turned;
  for (const Vec3& x : reference) turned.push_back(frame.to_solver(x));
  coupling::Sampling sampling(std::move(sampled), turned, scene.real("coupling.spacing_cells") * h, left_out);
  auto body =
      std::make_unique<TurnedBody>(std::move(structure), frame, std::move(sampling), low_, high_, couples_);
  body_ = body.get();
  points_ = body->coupling_points().size();

  coupling::ImmersedFlowSettings in;
  in.kernel = coupling::kernel_from(scene.text("coupling.kernel"));
  in.beyond = beyond;
  in.limits.safety = scene.real("coupling.step_safety");
  in.limits.largest_s = scene.real("fluid.end_s");
  in.limits.cfl = cfl;
  in.limits.smallest_s = smallest_s;
  in.probe_interval = static_cast<int>(scene.integer("coupling.probe_interval"));
  in.probe_iterations = static_cast<int>(scene.integer("coupling.probe_iterations"));
  in.largest_stretch = scene.real("coupling.largest_stretch");
  system_ = std::make_unique<coupling::ImmersedFlow>(flow, std::move(body), in);
  if (body_->structure().has_twins() && !(tie_rate_ > 0)) {
    tie_rate_ = auto_tie_rate(flow_step_s);
    body_->structure().set_tie_rate(tie_rate_);
  }
  if (!body_->structure().has_twins()) tie_rate_ = 0;
}

double Bodies::auto_tie_rate(double flow_step_s) const {
  const double limit_s =
      std::min(tie_limit_over_elastic * system_->find_critical(), tie_limit_over_flow * flow_step_s);
  const double rate = 2 / (limit_s * std::sqrt(1 + density_ratio_));
  if (!(rate > 0) || !std::isfinite(rate))
    throw InputError(
        "{}: coupling.tie_rate_per_s is 0 and no body has a stiffness to take it from; expected a positive "
        "one, 40 times the angular frequency of the motion",
        file_);
  const double digit = std::pow(10, std::floor(std::log10(rate)) - 1);  // the same on any number of ranks
  return digit * std::floor(rate / digit);
}

void Bodies::check_places(const fluid::Flow& flow, const Frame& frame, const coupling::Surroundings& beyond) {
  const fluid::Grid& grid = flow.grid();
  for (int e = 0; e < 3; ++e) {
    const int own = frame.solver_axis(e);
    const bool bound = !flow.boundaries().periodic(own);
    const auto room = [&](int side) {
      return (beyond[own][side] == coupling::Beyond::nothing ? room_cells : -round_off) * grid.h;
    };
    low_[e] = bound ? grid.low()[own] + room(0) : -1e300;
    high_[e] = bound ? grid.high()[own] - room(1) : 1e300;
  }
  const Points& x = scene_.system->state.x;
  for (std::size_t a = 0; a < x.size(); ++a)
    for (int e = 0; e < 3; ++e) {
      if (!couples_[a] || (x[a][e] >= low_[e] && x[a][e] <= high_[e])) continue;
      throw InputError(
          "{}: [[body]]: {} at ({:.6g}, {:.6g}, {:.6g}) mm is outside fluid.box_mm along {}, or less than {} "
          "cells of {:.4g} mm from an open side or an inflow; expected a larger box",
          file_, scene_.system->describe(static_cast<int>(a)), x[a].x(), x[a].y(), x[a].z(), "xyz"[e],
          room_cells, grid.h);
    }
}

coupling::ImmersedStep Bodies::step(double start_s, double at_most, coupling::StepHooks hooks) {
  structure::System& system = *scene_.system;
  system.state.time_s = start_s;
  const std::vector<Motion> before = motions();
  hooks.set_ends = [&, ends = std::move(hooks.set_ends)](double dt) {
    ends(dt);
    drive_->set_velocities(system, start_s + dt, dt);
  };
  const coupling::ImmersedStep done = system_->step(at_most, hooks);
  const std::vector<Motion> after = motions();
  for (std::size_t b = 0; b < rate_.size(); ++b) {
    rate_[b].momentum = (after[b].momentum - before[b].momentum) / done.dt_s;
    rate_[b].angular = (after[b].angular - before[b].angular) / done.dt_s;
  }
  repeats_ += done.repeats;
  critical_s_ = done.critical_s;
  largest_slip_ = std::max(largest_slip_, structure().largest_slip());
  return done;
}

Bodies::Motion Bodies::motion_of(const BuiltBody& body) const {
  const structure::System& system = *scene_.system;
  Motion out;
  for (int a = body.at.begin(); a < body.at.end(); ++a) {
    const Vec3& v = system.state.v[a];
    const Vec3 p = system.mass(a) * (v - system.held_directions(a) * v);
    out.momentum += p;
    out.angular += system.state.x[a].cross(p);
    const int r = system.rotation_of(a);
    if (r < 0) continue;
    const Vec3& w = system.state.angular_velocity[r];
    out.angular += system.inertia(r) * (w - system.held_axes(r) * w);
  }
  return out;
}

std::vector<Bodies::Motion> Bodies::motions() const {
  std::vector<Motion> all;
  for (const BuiltBody& body : scene_.bodies) all.push_back(motion_of(body));
  return all;
}

Obstacles::Load Bodies::load_on(const std::string& name, const Vec3& about) const {
  const structure::System& system = *scene_.system;
  structure::Forces f;
  f.reset(system.nodes(), system.rotational_nodes());
  for (const auto& term : scene_.terms) term->add_forces(system.state, f);
  structure().leave_out_constraints(f.force);
  Obstacles::Load load{Vec3::Zero(), Vec3::Zero()};
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    const BuiltBody& body = scene_.bodies[b];
    if (body.name != name) continue;
    load.force = rate_[b].momentum;
    load.moment = rate_[b].angular - about.cross(rate_[b].momentum);
    for (int a = body.at.begin(); a < body.at.end(); ++a) {
      const Vec3 free = f.force[a] - system.held_directions(a) * f.force[a];
      load.force -= free;
      load.moment -= (system.state.x[a] - about).cross(free);
      const int r = system.rotation_of(a);
      if (r >= 0) load.moment -= f.moment[r] - system.held_axes(r) * f.moment[r];
    }
  }
  return load;
}

std::map<std::string, double> Bodies::metrics() const {
  double nodes = 0, elements = 0;
  for (const BuiltBody& body : scene_.bodies) {
    nodes += body.at.count;
    elements +=
        static_cast<double>(body.mesh.triangles.size() + body.mesh.lines.size() + body.mesh.solids.size());
  }
  return {{"nodes", nodes},
          {"elements", elements},
          {"coupling_points", static_cast<double>(points_)},
          {"coupling_tie_rate_per_s", tie_rate_},
          {"coupling_largest_slip_mm", largest_slip_},
          {"coupling_largest_volume_change", structure().largest_volume_change()},
          {"coupling_critical_step_s", std::isfinite(critical_s_) ? critical_s_ : 0},
          {"coupling_repeated_steps", static_cast<double>(repeats_)},
          {"coupling_slowed_nodes", static_cast<double>(slowed_)}};
}

std::vector<double> Bodies::save() const {
  return {largest_slip_, critical_s_, static_cast<double>(repeats_), static_cast<double>(slowed_)};
}

void Bodies::restore(const std::vector<double>& saved) {
  if (saved.size() != 4)
    throw InputError("the state's figures of bodies have {} entries, expected 4", saved.size());
  largest_slip_ = saved[0];
  critical_s_ = saved[1];
  repeats_ = static_cast<long>(saved[2]);
  slowed_ = static_cast<long>(saved[3]);
}

}  // namespace valsalva::flow_scene
