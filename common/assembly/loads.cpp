#include "assembly/loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "assembly/volume_load.hpp"
#include "core/units.hpp"
#include "structure/dead_load.hpp"
#include "structure/kirchhoff_loads.hpp"
#include "structure/pressure.hpp"
#include "structure/solid_surface.hpp"

namespace valsalva::assembly {
namespace {

using Term = std::shared_ptr<structure::ForceTerm>;

class Loads {
 public:
  Loads(Scene& scene, const Entry& e, const TimeTable& standard)
      : s_(scene), e_(e), factor_(scene.factor_of(e, standard)) {}

  void add() {
    const std::string& kind = e_.text("kind");
    if (kind == "force") keep(nodal_load(false));
    if (kind == "moment") keep(nodal_load(true));
    if (kind == "pressure") keep(pressure());
    if (kind == "traction") keep(traction());
    if (kind == "gravity") keep(weight());
    if (kind == "volume") keep(volume());
  }

 private:
  void keep(Term term) {
    if (!term) return;
    s_.loads.push_back(term);
    s_.terms.push_back(std::move(term));
  }

  /// Shares of the nodes: 1 each, or summing to 1.
  std::vector<double> shares(const std::vector<int>& nodes) const {
    const std::string& how = e_.text("share");
    if (how == "node") return std::vector<double>(nodes.size(), 1);
    if (how == "total") return std::vector<double>(nodes.size(), 1.0 / static_cast<double>(nodes.size()));
    std::map<int, double> size;
    const std::set<int> chosen(nodes.begin(), nodes.end());
    for (const BuiltBody& body : s_.bodies) {
      const auto holds = [&](int a) { return chosen.contains(a + body.at.offset); };
      const auto share = [&](const auto& cell, double measure) {
        if (!std::all_of(cell.begin(), cell.end(), holds)) return;
        for (int a : cell) size[a + body.at.offset] += measure / static_cast<double>(cell.size());
      };
      const Points& x = body.mesh.points;
      if (how == "length") {
        for (const Edge& e : body.border()) share(e, (x[e[1]] - x[e[0]]).norm());
      } else {
        for (const Triangle& t : body.surface())
          share(t, 0.5 * (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm());
      }
    }
    double total = 0;
    for (const auto& [node, measure] : size) total += measure;
    if (!(total > 0))
      e_.fail(fmt::format("share = \"{}\": no {} has all its nodes in the set", how,
                          how == "length" ? "border edge or beam" : "triangle of a surface"));
    std::vector<double> out;
    for (int a : nodes) out.push_back(size[a] / total);
    return out;
  }

  /// Border edges of the body with both nodes in the set, as the surface runs; nodes of the mesh.
  static std::vector<Edge> border_within(const BuiltBody& body, const std::vector<int>& nodes) {
    const std::set<int> chosen(nodes.begin(), nodes.end());
    std::vector<Edge> edges = body.border();
    std::erase_if(edges, [&](const Edge& e) {
      return !chosen.contains(e[0] + body.at.offset) || !chosen.contains(e[1] + body.at.offset);
    });
    return edges;
  }

  static Edge ascending(const Edge& e) { return {std::min(e[0], e[1]), std::max(e[0], e[1])}; }

  /// Moment along the edge of a Kirchhoff shell: each edge takes the part along itself.
  void edge_moment(const BuiltBody& body, const std::vector<int>& nodes, const Vec3& full) {
    const std::vector<Edge> edges = border_within(body, nodes);
    const Points& x = body.mesh.points;
    double length = 0;
    for (const Edge& e : edges) length += (x[e[1]] - x[e[0]]).norm();
    if (edges.empty()) e_.fail("moment: the set holds no border edge of the shell");
    std::map<long, std::pair<double, std::vector<Edge>>> by_moment;
    for (const Edge& e : edges) {
      // The term's moment turns the outer side towards the normal: left-handed about the edge.
      const double part = -full.normalized().dot((x[e[1]] - x[e[0]]).normalized());
      auto& [moment, list] = by_moment[std::lround(part * 1e9)];
      moment = full.norm() * part / (e_.text("share") == "node" ? 1 : length);
      list.push_back(ascending(e));
    }
    bool any = false;
    for (auto& [key, group] : by_moment) {
      if (std::abs(key) < 1) continue;
      any = true;
      std::sort(group.second.begin(), group.second.end());
      keep(std::make_shared<structure::EdgeMomentTerm>(
          e_.text("name"), body.kirchhoff, body.at, group.second,
          [m = group.first, factor = factor_](double t) { return m * factor(t); }));
    }
    if (!any) e_.fail("moment_N_mm is normal to all border edges of the set; expected a part along them");
  }

  Term nodal_load(bool moment) {
    const std::vector<int>& nodes = s_.set(e_.text("nodes"), e_.what());
    const Vec3 full = units::uN_per_N * e_.vector(moment ? "moment_N_mm" : "force_N");
    if (full.isZero()) e_.fail(moment ? "moment_N_mm is zero" : "force_N is zero; expected a force");
    const BuiltBody& first = s_.body_of(nodes.front());
    if (moment && first.kirchhoff) {
      edge_moment(first, nodes, full);
      return nullptr;
    }
    const std::vector<double> share = shares(nodes);
    Points force, turning;
    (moment ? turning : force)
        .assign(moment ? s_.system->rotational_nodes() : s_.system->nodes(), Vec3::Zero());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!moment) {
        force[nodes[i]] += share[i] * full;
        continue;
      }
      const int r = s_.system->rotation_of(nodes[i]);
      if (r < 0)
        e_.fail(fmt::format("{} has no rotation; expected beam nodes", s_.system->describe(nodes[i])));
      turning[r] += share[i] * full;
    }
    return std::make_shared<structure::DeadLoadTerm>(e_.text("name"), force, turning, factor_);
  }

  /// Is the node of the body loaded?
  std::vector<std::uint8_t> loaded_nodes(const BuiltBody& body) const {
    std::vector<std::uint8_t> loaded(body.at.count, e_.text("nodes").empty() ? 1 : 0);
    if (!e_.text("nodes").empty())
      for (int a : s_.set(e_.text("nodes"), e_.what()))
        if (a >= body.at.begin() && a < body.at.end()) loaded[a - body.at.offset] = 1;
    return loaded;
  }

  std::vector<structure::SolidFace> faces(const BuiltBody& body) const {
    const auto loaded = loaded_nodes(body);
    std::vector<structure::SolidFace> all = structure::boundary_faces(body.solid->mesh());
    std::erase_if(all, [&](const auto& face) {
      return !std::all_of(face.nodes.begin(), face.nodes.end(), [&](int a) { return loaded[a] != 0; });
    });
    if (all.empty()) e_.fail("no outer face has all its nodes in the set");
    return all;
  }

  std::vector<Triangle> triangles(const BuiltBody& body, const std::vector<Triangle>& from) const {
    const auto loaded = loaded_nodes(body);
    std::vector<Triangle> all = from;
    std::erase_if(all, [&](const Triangle& t) {
      return !std::all_of(t.begin(), t.end(), [&](int a) { return loaded[a] != 0; });
    });
    if (all.empty()) e_.fail("no triangle has all its nodes in the set");
    return all;
  }

  const BuiltBody& loaded_body() const {
    const BuiltBody& body = s_.body(e_.text("body"), e_.what());
    const bool rigid = body.kind == Kind::rigid && !body.free;
    if (body.kind == Kind::beams || rigid)
      e_.fail(fmt::format("body '{}' has no surface to load; expected a shell, a solid or a free rigid body",
                          body.name));
    return body;
  }

  Term pressure() const {
    const BuiltBody& body = loaded_body();
    const double p = units::pa_per_kPa * e_.real("pressure_kPa");
    if (p == 0) e_.fail("pressure_kPa is zero; expected a pressure");
    const auto at = [p, factor = factor_](double t) { return p * factor(t); };
    if (body.kind == Kind::solid)
      return std::make_shared<structure::SolidPressureTerm>(e_.text("name"), faces(body), body.at, at);
    return std::make_shared<structure::PressureTerm>(e_.text("name"), triangles(body, body.mesh.triangles),
                                                     body.at, at);
  }

  Term traction() const {
    const BuiltBody& body = loaded_body();
    const Vec3 t = units::pa_per_kPa * e_.vector("traction_kPa");
    if (t.isZero()) e_.fail("traction_kPa is zero; expected a traction");
    Points on_body(body.at.count, Vec3::Zero());
    if (body.kind == Kind::solid) {
      on_body = structure::traction_forces(body.solid->mesh(), faces(body), [&](const Vec3&) { return t; });
    } else {
      const Points& x = body.mesh.points;
      for (const Triangle& tri : triangles(body, body.mesh.triangles))
        for (int n : tri) on_body[n] += (x[tri[1]] - x[tri[0]]).cross(x[tri[2]] - x[tri[0]]).norm() / 6 * t;
    }
    Points force(s_.system->nodes(), Vec3::Zero());
    std::copy(on_body.begin(), on_body.end(), force.begin() + body.at.offset);
    return std::make_shared<structure::DeadLoadTerm>(e_.text("name"), force, Points{}, factor_);
  }

  Term weight() const {
    const Vec3 g = e_.vector("acceleration_mm_per_s2");
    if (g.isZero()) e_.fail("acceleration_mm_per_s2 is zero; expected one, on earth 9810");
    Points force(s_.system->nodes(), Vec3::Zero());
    bool any = false, nodes = false;
    for (const BuiltBody& body : s_.bodies) {
      const bool rigid = body.kind == Kind::rigid && !body.rigid;
      if (rigid || (!e_.text("body").empty() && body.name != e_.text("body"))) continue;
      any = true;
      if (body.rigid) {
        body.rigid->add_gravity([g, factor = factor_](double t) -> Vec3 { return factor(t) * g; });
        continue;
      }
      nodes = true;
      const Points own = structure::weight_of(*s_.system, body.at, g);
      for (std::size_t a = 0; a < own.size(); ++a) force[a] += own[a];
    }
    if (!any)
      e_.fail(fmt::format("body: found '{}', expected a deformable or free rigid body, or none for all",
                          e_.text("body")));
    if (!nodes) return nullptr;
    return std::make_shared<structure::DeadLoadTerm>(e_.text("name"), force, Points{}, factor_);
  }

  Term volume() const {
    const BuiltBody& body = loaded_body();
    if (e_.real("volume_ratio") == 1) e_.fail("volume_ratio is 1; expected another");
    std::vector<Triangle> all = triangles(body, body.surface());
    for (Triangle& t : all)
      for (int& a : t) a += body.at.offset;
    auto term = std::make_shared<VolumeLoad>(e_.what(), std::move(all), e_.vector("point_mm"),
                                             s_.system->state.x, e_.real("volume_ratio"),
                                             units::pa_per_kPa * e_.real("bulk_kPa"), factor_);
    if (!s_.volumes.emplace(e_.text("name"), term).second) e_.fail("there are two volume loads of this name");
    return term;
  }

  Scene& s_;
  const Entry& e_;
  TimeTable factor_;
};

}  // namespace

void add_load(Scene& scene, const Entry& e, const TimeTable& standard) {
  Loads(scene, e, standard).add();
}

}  // namespace valsalva::assembly
