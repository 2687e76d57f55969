#include "assembly/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "assembly/select.hpp"
#include "assembly/shell_edge.hpp"
#include "core/errors.hpp"
#include "core/units.hpp"
#include "structure/dead_load.hpp"
#include "structure/pressure.hpp"
#include "structure/tie.hpp"

namespace valsalva::assembly {
namespace {

using structure::System;

/// One entry of a repeated table, with messages that say where.
class Entry {
 public:
  Entry(const Case& scene, const std::string& table, const Case& entry)
      : table_(table),
        in_(entry),
        what_(fmt::format("{}: [[{}]] '{}'", scene.file().string(), table, text("name"))) {
    if (text("name").empty()) fail("name is missing; expected one");
  }
  const std::string& text(const std::string& key) const { return in_.text(table_ + "." + key); }
  double real(const std::string& key) const { return in_.real(table_ + "." + key); }
  bool boolean(const std::string& key) const { return in_.boolean(table_ + "." + key); }
  const std::vector<double>& reals(const std::string& key) const { return in_.reals(table_ + "." + key); }
  const std::vector<std::string>& texts(const std::string& key) const {
    return in_.texts(table_ + "." + key);
  }
  bool is_set(const std::string& key) const { return in_.is_set(table_ + "." + key); }
  Vec3 vector(const std::string& key) const {
    const auto& v = reals(key);
    return {v[0], v[1], v[2]};
  }
  Vec3 direction(const std::string& key) const {
    const Vec3 v = vector(key);
    if (!(v.norm() > 0)) fail(fmt::format("{} is zero; expected a direction", key));
    return v.normalized();
  }
  TimeTable table(const TimeTable& standard) const {
    if (reals("time_s").empty() && reals("factor").empty()) return standard;
    return {reals("time_s"), reals("factor"), what_};
  }
  [[noreturn]] void fail(const std::string& message) const { throw InputError("{}: {}", what_, message); }
  const std::string& what() const { return what_; }

 private:
  std::string table_;
  const Case& in_;
  std::string what_;
};

class Composer {
 public:
  explicit Composer(const Case& scene) : case_(scene) {
    s_.system = std::make_unique<System>();
    s_.end_s = scene.real("dynamics.end_s");
    const std::string& solver = scene.text("dynamics.solver");
    static_ = solver == "static" || solver == "quasi_static";
  }

  Scene compose() {
    if (case_.entries("body").empty())
      throw InputError("{}: the scene has no [[body]]; expected at least one", case_.file().string());
    for (const Case& entry : case_.entries("body")) add_body(entry);
    for (const Case& entry : case_.entries("nodes")) add_nodes({case_, "nodes", entry});
    for (const Case& entry : case_.entries("support")) add_support({case_, "support", entry});
    for (const Case& entry : case_.entries("tie")) add_tie({case_, "tie", entry});
    for (const Case& entry : case_.entries("load")) add_load({case_, "load", entry});
    for (const Case& entry : case_.entries("contact_pair")) add_contact({case_, "contact_pair", entry});
    return std::move(s_);
  }

 private:
  void add_term(const std::string& name, std::shared_ptr<structure::ForceTerm> term,
                const std::string& what) {
    if (!s_.named.emplace(name, term).second)
      throw InputError("{}: the name is taken by another body, tie, support or contact pair", what);
    s_.terms.push_back(std::move(term));
  }

  void add_body(const Case& entry) {
    BuiltBody body = build_body(case_, entry);
    const std::string what = fmt::format("{}: [[body]] '{}'", case_.file().string(), body.name);
    auto term = add_to_system(body, *s_.system);
    if (term) add_term(body.name, std::move(term), what);
    s_.bodies.push_back(std::move(body));
  }

  void add_nodes(const Entry& e) {
    const BuiltBody& body = s_.body(e.text("body"), e.what());
    std::vector<int> nodes = chosen(e, body);
    if (nodes.empty())
      e.fail(fmt::format("no node of '{}' is in it; expected at least one: look at place and tolerance_mm",
                         body.name));
    for (int& a : nodes) a += body.at.offset;
    if (!s_.nodes.emplace(e.text("name"), std::move(nodes)).second) e.fail("there are two sets of this name");
  }

  std::vector<int> chosen(const Entry& e, const BuiltBody& body) const {
    const std::string& how = e.text("select");
    std::vector<int> nodes;
    if (how == "all") {
      for (int a = 0; a < body.at.count; ++a) nodes.push_back(a);
    } else if (how == "group") {
      const auto group = body.mesh.groups.find(e.text("group"));
      if (group == body.mesh.groups.end()) {
        std::string known;
        for (const auto& [name, list] : body.mesh.groups) known += (known.empty() ? "" : ", ") + name;
        e.fail(fmt::format("body '{}' has no group '{}'; its groups: {}", body.name, e.text("group"),
                           known.empty() ? "none" : known));
      }
      nodes = group->second;
    } else if (how == "numbers") {
      for (double number : e.reals("numbers")) {
        if (number != std::floor(number) || number >= body.at.count)
          e.fail(fmt::format("numbers: found {}, expected whole numbers from 0 to {}", number,
                             body.at.count - 1));
        nodes.push_back(static_cast<int>(number));
      }
    } else {
      Selection s;
      s.place = how == "box"       ? Place::box
                : how == "plane"   ? Place::plane
                : how == "sphere"  ? Place::sphere
                : how == "nearest" ? Place::nearest
                                   : Place::cylinder;
      s.low = e.vector("low_mm");
      s.high = e.vector("high_mm");
      s.point = e.vector("point_mm");
      s.direction = e.direction("direction");
      s.radius = e.real("radius_mm");
      s.inside = e.boolean("inside");
      s.tolerance = e.real("tolerance_mm");
      nodes = select(body.mesh.points, s);
    }
    return nodes;
  }

  Motion motion_of(const Entry& e) const {
    Motion m;
    m.factor = e.table(TimeTable::ramp(s_.end_s));
    m.displacement = e.vector("displacement_mm");
    return m;
  }

  void add_support(const Entry& e) {
    Support s;
    s.name = e.text("name");
    s.nodes = s_.set(e.text("nodes"), e.what());
    if (e.texts("hold").empty()) e.fail("hold is empty; expected any of x, y, z, rx, ry, rz, all, symmetry");
    const std::string axes = "xyz";
    for (const std::string& word : e.texts("hold")) {
      if (word == "all") {
        s.translation.fill(true);
        s.rotation.fill(true);
      } else if (word == "symmetry") {
        s.symmetry = true;
        s.normal = e.direction("normal");
      } else if (word.size() == 1 && axes.find(word[0]) != std::string::npos) {
        s.translation[axes.find(word[0])] = true;
      } else if (word.size() == 2 && word[0] == 'r' && axes.find(word[1]) != std::string::npos) {
        s.rotation[axes.find(word[1])] = true;
      } else {
        e.fail(fmt::format("hold: found '{}', expected any of x, y, z, rx, ry, rz, all, symmetry", word));
      }
    }
    if (s.symmetry && e.texts("hold").size() > 1) e.fail("hold: symmetry stands alone; use a second support");
    s.motion = motion_of(e);
    s.motion.turn_rad = e.real("turn_deg") * M_PI / 180;
    s.motion.turn_axis = e.direction("turn_axis");
    s.motion.turn_point = e.vector("turn_point_mm");
    if (s.symmetry && s.motion.moves())
      e.fail("a symmetry plane does not move; expected no displacement or turn");
    for (int d = 0; d < 3; ++d)
      if (s.motion.displacement[d] != 0 && !s.translation[d])
        e.fail(fmt::format("displacement_mm moves {}, which hold does not name", axes[d]));
    if (s.motion.turn_rad != 0 && !(s.translation[0] && s.translation[1] && s.translation[2]))
      e.fail("turn_deg needs hold = [\"all\"] or [\"x\", \"y\", \"z\"]");
    s.tether_uN_per_mm = e.real("stiffness_N_per_mm") * units::uN_per_N;
    hold(s, *s_.system);
    hold_edges(s);
    if (s.tether_uN_per_mm > 0) add_term(s.name, std::make_shared<TetherTerm>(s, *s_.system), e.what());
    s_.supports.push_back(std::move(s));
  }

  void hold_edges(const Support& s) {
    if (s.tether_uN_per_mm > 0) return;
    for (const BuiltBody& body : s_.bodies) {
      if (body.kind != Kind::shell) continue;
      auto term = std::make_shared<ShellEdgeTerm>(body, s);
      if (!term->empty()) s_.terms.push_back(std::move(term));
    }
  }

  TimeTable load_table(const Entry& e) const {
    return e.table(static_ ? TimeTable::ramp(s_.end_s) : TimeTable::constant(1));
  }

  void add_load(const Entry& e) {
    const std::string& kind = e.text("kind");
    std::shared_ptr<structure::ForceTerm> term;
    if (kind == "force" || kind == "moment") term = nodal_load(e, kind == "moment");
    if (kind == "pressure" || kind == "traction") term = surface_load(e, kind == "pressure");
    if (kind == "gravity") term = weight(e);
    s_.loads.push_back(term);
    s_.terms.push_back(std::move(term));
  }

  std::shared_ptr<structure::ForceTerm> nodal_load(const Entry& e, bool moment) const {
    const std::vector<int>& nodes = s_.set(e.text("nodes"), e.what());
    Vec3 each = units::uN_per_N * e.vector(moment ? "moment_N_mm" : "force_N");
    if (each.isZero()) e.fail(moment ? "moment_N_mm is zero" : "force_N is zero; expected a force");
    if (e.text("share") == "total") each /= static_cast<double>(nodes.size());
    Points force, turning;
    (moment ? turning : force)
        .assign(moment ? s_.system->rotational_nodes() : s_.system->nodes(), Vec3::Zero());
    for (int a : nodes) {
      const int r = s_.system->rotation_of(a);
      if (moment && r < 0)
        e.fail(fmt::format("{} has no rotation; expected beam nodes", s_.system->describe(a)));
      if (moment)
        turning[r] += each;
      else
        force[a] += each;
    }
    return std::make_shared<structure::DeadLoadTerm>(e.text("name"), force, turning, load_table(e));
  }

  std::shared_ptr<structure::ForceTerm> surface_load(const Entry& e, bool pressure) const {
    const BuiltBody& body = s_.body(e.text("body"), e.what());
    std::vector<std::uint8_t> loaded(body.at.count, e.text("nodes").empty() ? 1 : 0);
    if (!e.text("nodes").empty())
      for (int a : s_.set(e.text("nodes"), e.what()))
        if (a >= body.at.begin() && a < body.at.end()) loaded[a - body.at.offset] = 1;
    const auto all = [&](const auto& nodes) {
      return std::all_of(nodes.begin(), nodes.end(), [&](int a) { return loaded[a] != 0; });
    };
    const double p = units::pa_per_kPa * e.real("pressure_kPa");
    const Vec3 traction = units::pa_per_kPa * e.vector("traction_kPa");
    const TimeTable factor = load_table(e);
    if (body.kind == Kind::solid) {
      std::vector<structure::SolidFace> faces = structure::boundary_faces(body.solid->mesh());
      std::erase_if(faces, [&](const auto& face) { return !all(face.nodes); });
      if (faces.empty()) e.fail("no outer face has all its nodes in the set");
      if (pressure)
        return std::make_shared<structure::SolidPressureTerm>(e.text("name"), std::move(faces), body.at,
                                                              [=](double t) { return p * factor(t); });
      return dead(
          e, body,
          structure::traction_forces(body.solid->mesh(), faces, [&](const Vec3&) { return traction; }),
          factor);
    }
    if (body.kind != Kind::shell)
      e.fail(fmt::format("body '{}' has no surface to load; expected a shell or a solid", body.name));
    std::vector<Triangle> triangles = body.mesh.triangles;
    std::erase_if(triangles, [&](const Triangle& t) { return !all(t); });
    if (triangles.empty()) e.fail("no triangle has all its nodes in the set");
    if (pressure)
      return std::make_shared<structure::PressureTerm>(e.text("name"), std::move(triangles), body.at,
                                                       [=](double t) { return p * factor(t); });
    Points force(body.at.count, Vec3::Zero());
    for (const Triangle& t : triangles) {
      const Vec3 &a = body.mesh.points[t[0]], &b = body.mesh.points[t[1]], &c = body.mesh.points[t[2]];
      for (int n : t) force[n] += (b - a).cross(c - a).norm() / 6 * traction;
    }
    return dead(e, body, force, factor);
  }

  std::shared_ptr<structure::ForceTerm> dead(const Entry& e, const BuiltBody& body, const Points& on_body,
                                             const TimeTable& factor) const {
    Points force(s_.system->nodes(), Vec3::Zero());
    std::copy(on_body.begin(), on_body.end(), force.begin() + body.at.offset);
    return std::make_shared<structure::DeadLoadTerm>(e.text("name"), force, Points{}, factor);
  }

  std::shared_ptr<structure::ForceTerm> weight(const Entry& e) const {
    const Vec3 g = e.vector("acceleration_mm_per_s2");
    if (g.isZero()) e.fail("acceleration_mm_per_s2 is zero; expected one, on earth 9810");
    Points force(s_.system->nodes(), Vec3::Zero());
    bool any = false;
    for (const BuiltBody& body : s_.bodies) {
      if (body.kind == Kind::rigid || (!e.text("body").empty() && body.name != e.text("body"))) continue;
      any = true;
      const Points own = structure::weight_of(*s_.system, body.at, g);
      for (std::size_t a = 0; a < own.size(); ++a) force[a] += own[a];
    }
    if (!any)
      e.fail(fmt::format("body: found '{}', expected a deformable body, or none for all", e.text("body")));
    return std::make_shared<structure::DeadLoadTerm>(e.text("name"), force, Points{}, load_table(e));
  }

  void add_tie(const Entry& e) {
    const std::vector<int>&from = s_.set(e.text("nodes"), e.what()), &to = s_.set(e.text("to"), e.what());
    const Points& x = s_.system->state.x;
    double stiffness = units::uN_per_N * e.real("stiffness_N_per_mm");
    if (stiffness == 0) stiffness = mean_stiffness(from, e);
    std::vector<structure::Tie> ties;
    for (int a : from) {
      int nearest = -1;
      for (int b : to)
        if (b != a && (nearest < 0 || (x[b] - x[a]).norm() < (x[nearest] - x[a]).norm())) nearest = b;
      if (nearest < 0) e.fail("the two sets are the same single node; expected two places");
      ties.push_back({a, nearest, x[a] - x[nearest], stiffness});
    }
    add_term(e.text("name"),
             std::make_shared<structure::TieTerm>(e.text("name"), std::move(ties), *s_.system), e.what());
  }

  double mean_stiffness(const std::vector<int>& nodes, const Entry& e) const {
    structure::StiffnessBound bound;
    bound.reset(s_.system->nodes(), s_.system->rotational_nodes());
    for (const auto& term : s_.terms) term->add_stiffness_bound(s_.system->state, bound);
    double sum = 0;
    for (int a : nodes) sum += bound.translation[a];
    if (!(sum > 0)) e.fail("stiffness_N_per_mm is 0 and the tied nodes have none of their own; expected one");
    return sum / static_cast<double>(nodes.size());
  }

  void add_contact(const Entry& e) {
    const BuiltBody& body = s_.body(e.text("body"), e.what());
    const bool surface = e.text("surface") != "none";
    if (surface == !e.text("other").empty())
      e.fail("found both or neither of other and surface; expected one of them");
    s_.first_body[e.text("name")] = body.name;
    if (surface)
      add_rigid_surface(e, body);
    else
      add_body_contact(e, body, s_.body(e.text("other"), e.what()));
  }

  void add_rigid_surface(const Entry& e, const BuiltBody& body) {
    RigidShape shape;
    shape.kind = e.text("surface") == "plane"    ? RigidShape::Kind::plane
                 : e.text("surface") == "sphere" ? RigidShape::Kind::sphere
                                                 : RigidShape::Kind::cylinder;
    shape.point = e.vector("point_mm");
    shape.direction = e.direction("direction");
    shape.radius = e.real("radius_mm");
    shape.inside = e.boolean("inside");
    if (shape.kind != RigidShape::Kind::plane && !(shape.radius > 0))
      e.fail(fmt::format("radius_mm is {}; expected a positive radius", shape.radius));
    const std::vector<double> area = body.surface_area();
    std::vector<contact::SurfaceNode> nodes;
    for (int a = 0; a < body.at.count; ++a)
      if (area[a] > 0)
        nodes.push_back({body.at.offset + a,
                         e.real("offset_mm") < 0 ? body.half_thickness[a] : e.real("offset_mm"), area[a]});
    const double stiffness = units::pa_per_kPa * e.real("stiffness_kPa_per_mm");
    const Motion motion = motion_of(e);
    add_term(e.text("name"),
             std::make_shared<RigidSurfaceContact>(
                 e.text("name"), shape, [motion](double t) { return motion.place(Vec3::Zero(), t); },
                 std::move(nodes), contact::SurfaceParameters{stiffness, e.real("friction"), stiffness}),
             e.what());
  }

  void add_body_contact(const Entry& e, const BuiltBody& one, const BuiltBody& other) {
    if (e.real("friction") > 0)
      e.fail(fmt::format("friction is {}; expected 0: bodies rub against rigid surfaces only",
                         e.real("friction")));
    contact::CollisionMesh mesh(s_.system->state.x);
    add_collision_body(e, mesh, one);
    const bool self = one.name == other.name;
    if (!self) add_collision_body(e, mesh, other);
    contact::CandidateParameters parameters;
    parameters.modulus_Pa = units::pa_per_kPa * e.real("modulus_kPa");
    parameters.rest_factor = case_.real("contact.rest_factor");
    parameters.wide_skin_mm = case_.real("contact.wide_skin_mm");
    parameters.near_skin_mm = case_.real("contact.near_skin_mm");
    contact::Candidates candidates(std::move(mesh), parameters);
    if (!self) {
      candidates.set_pair(one.name, one.name, {false});
      candidates.set_pair(other.name, other.name, {false});
    }
    candidates.set_pair(one.name, other.name, {true, e.real("distance_mm")});
    auto term = std::make_shared<contact::BodyContact>(
        std::move(candidates), e.text("law") == "penalty" ? contact::Law::penalty : contact::Law::barrier);
    s_.body_contacts.push_back(term);
    add_term(e.text("name"), std::move(term), e.what());
  }

  void add_collision_body(const Entry& e, contact::CollisionMesh& mesh, const BuiltBody& body) const {
    const int group = static_cast<int>(mesh.bodies().size());
    std::vector<double> radius = body.half_thickness;
    if (const double distance = e.real("distance_mm"); distance > 0)
      for (double& r : radius)
        if (!(r > 0)) r = 0.5 * distance;
    for (double r : radius)
      if (!(r > 0)) e.fail(fmt::format("body '{}' has no thickness; expected distance_mm", body.name));
    if (body.kind == Kind::beams)
      mesh.add_beams({body.name, group}, body.at.offset, body.mesh.lines,
                     std::vector<double>(body.mesh.lines.size(), radius.front()));
    else
      mesh.add_shell({body.name, group}, body.at.offset, body.surface(), radius);
  }

  const Case& case_;
  Scene s_;
  bool static_ = false;
};

}  // namespace

const BuiltBody& Scene::body(const std::string& name, const std::string& what) const {
  std::string known;
  for (const BuiltBody& b : bodies) {
    if (b.name == name) return b;
    known += (known.empty() ? "" : ", ") + b.name;
  }
  throw InputError("{}: there is no body '{}'; expected one of: {}", what, name, known);
}

const std::vector<int>& Scene::set(const std::string& name, const std::string& what) const {
  if (const auto found = nodes.find(name); found != nodes.end()) return found->second;
  std::string known;
  for (const auto& [one, list] : nodes) known += (known.empty() ? "" : ", ") + one;
  throw InputError("{}: there is no set of nodes '{}'; expected one of [[nodes]]: {}", what, name,
                   known.empty() ? "none is defined" : known);
}

Scene compose(const Case& scene) {
  return Composer(scene).compose();
}

}  // namespace valsalva::assembly
