#include "assembly/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "assembly/contacts.hpp"
#include "assembly/entry.hpp"
#include "assembly/loads.hpp"
#include "assembly/select.hpp"
#include "assembly/shell_edge.hpp"
#include "core/units.hpp"
#include "structure/tie.hpp"

namespace valsalva::assembly {
namespace {

using structure::System;

class Composer {
 public:
  Composer(const Case& scene, const References& references, std::optional<double> end_s, Course course)
      : case_(scene), references_(references) {
    s_.system = std::make_unique<System>();
    s_.end_s = end_s.value_or(scene.real("dynamics.end_s"));
    s_.course = course;
    const std::string& solver = scene.text("dynamics.solver");
    static_ = !end_s && (solver == "static" || solver == "quasi_static");
  }

  Scene compose() {
    if (case_.entries("body").empty())
      throw InputError("{}: the scene has no [[body]]; expected at least one", case_.file().string());
    for (const Case& entry : case_.entries("body")) add_body(entry);
    for (const Case& entry : case_.entries("nodes")) add_nodes({case_, "nodes", entry});
    for (const Case& entry : case_.entries("support")) read_support({case_, "support", entry});
    for (BuiltBody& body : s_.bodies) complete(body);
    for (BuiltBody& body : s_.bodies) add_to_system(body);
    for (const Support& support : s_.supports) apply(support);
    for (const Case& entry : case_.entries("tie")) add_tie({case_, "tie", entry});
    for (const Case& entry : case_.entries("load"))
      add_load(s_, {case_, "load", entry}, static_ ? TimeTable::ramp(s_.end_s) : TimeTable::constant(1));
    for (const Case& entry : case_.entries("contact_pair"))
      add_contact(s_, case_, {case_, "contact_pair", entry});
    return std::move(s_);
  }

 private:
  std::string what(const BuiltBody& body) const {
    return fmt::format("{}: [[body]] '{}'", case_.file().string(), body.name);
  }

  void add_body(const Case& entry) {
    const auto reference = references_.find(entry.text("body.name"));
    BuiltBody body = build_body(case_, entry, reference == references_.end() ? nullptr : &reference->second);
    for (const BuiltBody& other : s_.bodies)
      if (other.name == body.name) throw InputError("{}: there are two bodies of this name", what(body));
    body.at.offset = s_.bodies.empty() ? 0 : s_.bodies.back().at.end();
    body.at.count = static_cast<int>(body.mesh.points.size());
    s_.bodies.push_back(std::move(body));
  }

  void complete(BuiltBody& body) const {
    if (!body.shell_mesh) return;
    try {
      complete_shell(body, edge_conditions(body, s_.supports));
    } catch (const InputError& error) {
      throw InputError("{}: {}", what(body), error.what());
    }
    std::vector<Motion> motions;
    bool turns = false;
    for (const Support& s : s_.supports) {
      motions.push_back(s.motion);
      turns = turns || s.motion.turn_rad != 0;
    }
    if (turns)
      body.clamps = [motions](double t) {
        std::vector<Mat3> turned;
        for (const Motion& m : motions) turned.push_back(m.turn(t));
        return turned;
      };
  }

  void add_to_system(BuiltBody& body) {
    const int offset = body.at.offset;
    auto term = assembly::add_to_system(body, *s_.system);
    VALSALVA_ASSERT(body.at.offset == offset);
    if (term) s_.add_term(body.name, std::move(term), what(body));
    if (body.rigid) s_.rigid.push_back(body.rigid);
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
    } else if (how == "union" || how == "intersection" || how == "difference") {
      nodes = combined(e, body, how);
    } else if (how == "border") {
      for (const Edge& edge : body.border()) nodes.insert(nodes.end(), edge.begin(), edge.end());
      if (body.kind == Kind::solid)
        for (const Triangle& t : body.surface()) nodes.insert(nodes.end(), t.begin(), t.end());
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
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
      nodes = select(body.imaged, s);
    }
    return nodes;
  }

  std::vector<int> combined(const Entry& e, const BuiltBody& body, const std::string& how) const {
    if (e.texts("sets").empty()) e.fail("sets is empty; expected names of [[nodes]] that stand above");
    std::vector<int> nodes;
    for (std::size_t k = 0; k < e.texts("sets").size(); ++k) {
      std::vector<int> next = s_.set(e.texts("sets")[k], e.what()), result;
      for (int& a : next) {
        if (a < body.at.begin() || a >= body.at.end())
          e.fail(fmt::format("set '{}' is of another body than '{}'", e.texts("sets")[k], body.name));
        a -= body.at.offset;
      }
      std::sort(next.begin(), next.end());
      const auto out = std::back_inserter(result);
      if (k == 0)
        result = next;
      else if (how == "union")
        std::set_union(nodes.begin(), nodes.end(), next.begin(), next.end(), out);
      else if (how == "intersection")
        std::set_intersection(nodes.begin(), nodes.end(), next.begin(), next.end(), out);
      else
        std::set_difference(nodes.begin(), nodes.end(), next.begin(), next.end(), out);
      nodes = std::move(result);
    }
    return nodes;
  }

  void read_support(const Entry& e) {
    Support s;
    s.name = e.text("name");
    for (const Support& other : s_.supports)
      if (other.name == s.name) e.fail("there are two supports of this name");
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
    s.motion = motion_of(e, s);
    s.tether_uN_per_mm = e.real("stiffness_N_per_mm") * units::uN_per_N;
    s_.supports.push_back(std::move(s));
  }

  Motion motion_of(const Entry& e, const Support& s) const {
    Motion m;
    m.factor = s_.factor_of(e, TimeTable::ramp(s_.end_s));
    m.displacement = e.vector("displacement_mm");
    m.turn_rad = e.real("turn_deg") * M_PI / 180;
    m.turn_axis = e.direction("turn_axis");
    m.turn_point = e.vector("turn_point_mm");
    if (const auto& g = e.reals("gradient"); !g.empty()) {
      if (g.size() != 9) e.fail(fmt::format("gradient has {} entries; expected 9, row by row", g.size()));
      m.gradient << g[0], g[1], g[2], g[3], g[4], g[5], g[6], g[7], g[8];
    }
    if (s.symmetry && m.moves()) e.fail("a symmetry plane does not move; expected no displacement or turn");
    for (int d = 0; d < 3; ++d)
      if ((m.displacement[d] != 0 || !m.gradient.row(d).isZero()) && !s.translation[d])
        e.fail(fmt::format("displacement_mm or gradient moves {}, which hold does not name", "xyz"[d]));
    const bool spins = s.rotation[0] || s.rotation[1] || s.rotation[2];
    if (m.turn_rad != 0 && !spins && !(s.translation[0] && s.translation[1] && s.translation[2]))
      e.fail("turn_deg needs hold = [\"all\"], [\"x\", \"y\", \"z\"] or rotations");
    return m;
  }

  void apply(Support s) {
    const BuiltBody& body = s_.body_of(s.nodes.front());
    if (s.tether_uN_per_mm > 0) {
      s_.add_term(s.name, std::make_shared<TetherTerm>(s, *s_.system),
                  fmt::format("{}: [[support]] '{}'", case_.file().string(), s.name));
      return;
    }
    hold(s, body, *s_.system);
    for (const BuiltBody& shell : s_.bodies) {
      if (!shell.shell) continue;
      auto term = std::make_shared<ShellEdgeTerm>(shell, s);
      if (!term->empty()) s_.terms.push_back(std::move(term));
    }
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
    s_.add_term(e.text("name"),
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

  const Case& case_;
  const References& references_;
  Scene s_;
  bool static_ = false;
};

}  // namespace

TimeTable Scene::factor_of(const Entry& entry, const TimeTable& standard) const {
  const TimeTable given = entry.table(standard);
  return course == Course::whole ? given : TimeTable::ramp(end_s, given(0));
}

void Scene::add_term(const std::string& name, std::shared_ptr<structure::ForceTerm> term,
                     const std::string& what) {
  if (!named.emplace(name, term).second)
    throw InputError("{}: the name is taken by another body, tie, support or contact pair", what);
  terms.push_back(std::move(term));
}

const BuiltBody& Scene::body_of(int node) const {
  for (const BuiltBody& b : bodies)
    if (node >= b.at.begin() && node < b.at.end()) return b;
  VALSALVA_ASSERT(!"a node of no body");
  return bodies.front();
}

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

Scene compose(const Case& scene, const References& references, std::optional<double> end_s, Course course) {
  return Composer(scene, references, end_s, course).compose();
}

double kinetic_of(const Scene& scene) {
  const structure::System& system = *scene.system;
  double twice = 0;
  for (std::size_t a = 0; a < system.nodes(); ++a)
    if (!system.held(static_cast<int>(a)))
      twice += system.mass(static_cast<int>(a)) * system.state.v[a].squaredNorm();
  for (std::size_t r = 0; r < system.rotational_nodes(); ++r)
    twice += system.inertia(static_cast<int>(r)) * system.state.angular_velocity[r].squaredNorm();
  for (const auto& body : scene.rigid) twice += 2 * body->kinetic_energy();
  return 0.5 * twice;
}

}  // namespace valsalva::assembly
