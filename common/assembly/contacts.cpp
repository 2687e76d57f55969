#include "assembly/contacts.hpp"

#include "assembly/mesh_file.hpp"
#include "bodies/level_set.hpp"
#include "core/units.hpp"
#include "geometry/level_set.hpp"
#include "geometry/surface.hpp"

namespace valsalva::assembly {
namespace {

class Contacts {
 public:
  Contacts(Scene& scene, const Case& file, const Entry& e) : s_(scene), case_(file), e_(e) {}

  void add() {
    const BuiltBody& body = s_.body(e_.text("body"), e_.what());
    const bool surface = e_.text("surface") != "none";
    if (surface == !e_.text("other").empty())
      e_.fail("found both or neither of other and surface; expected one of them");
    s_.first_body[e_.text("name")] = body.name;
    if (surface)
      add_rigid_surface(body);
    else
      add_body_contact(body, s_.body(e_.text("other"), e_.what()));
  }

 private:
  RigidShape shape() const {
    RigidShape shape;
    const std::string& kind = e_.text("surface");
    shape.kind = kind == "plane"      ? RigidShape::Kind::plane
                 : kind == "sphere"   ? RigidShape::Kind::sphere
                 : kind == "cylinder" ? RigidShape::Kind::cylinder
                                      : RigidShape::Kind::level_set;
    shape.point = e_.vector("point_mm");
    shape.direction = e_.direction("direction");
    shape.radius = e_.real("radius_mm");
    shape.inside = e_.boolean("inside");
    const bool round = shape.kind == RigidShape::Kind::sphere || shape.kind == RigidShape::Kind::cylinder;
    if (round && !(shape.radius > 0))
      e_.fail(fmt::format("radius_mm is {}; expected a positive radius", shape.radius));
    if (shape.kind == RigidShape::Kind::level_set)
      shape.level_set = std::make_shared<geometry::GridSdf>(level_set());
    return shape;
  }

  geometry::GridSdf level_set() const {
    if (e_.text("file").empty()) e_.fail("file is missing; expected a closed surface or a state");
    const auto path = case_.resolve(e_.text("file"));
    if (path.extension() == ".h5") return bodies::read_level_set(state::read(path, ""), "lumen");
    const BodyMesh mesh = read_mesh(path, Elements::triangles, "", 1);
    const geometry::TriMesh surface{mesh.points, mesh.triangles};
    if (!geometry::border_loops(surface).empty())
      e_.fail(fmt::format("file '{}' is not a closed surface", path.string()));
    if (!(geometry::enclosed_volume(surface) > 0))
      e_.fail(fmt::format("file '{}' has its normals inwards; expected a closed, outward surface",
                          path.string()));
    Vec3 low = surface.points.front(), high = low;
    for (const Vec3& p : surface.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    constexpr double most_samples = 2e8, margin = 6;  // margin: of samples beyond the surface
    const double h = e_.real("spacing_mm");
    geometry::GridSdf grid;
    grid.spacing = h;
    grid.origin = low - margin * h * Vec3::Ones();
    double samples = 1;
    for (int d = 0; d < 3; ++d) {
      grid.dimensions[d] = static_cast<int>((high[d] - low[d]) / h + 2 * margin) + 2;
      samples *= grid.dimensions[d];
    }
    if (samples > most_samples)
      e_.fail(fmt::format("spacing_mm {} gives {:.3g} samples; expected at most {:.0e}", h, samples,
                          most_samples));
    return geometry::signed_distance(surface, grid);
  }

  void add_rigid_surface(const BuiltBody& body) {
    const std::vector<double> area = body.surface_area();
    std::vector<contact::SurfaceNode> nodes;
    for (int a = 0; a < body.at.count; ++a)
      if (area[a] > 0)
        nodes.push_back({body.at.offset + a,
                         e_.real("offset_mm") < 0 ? body.half_thickness[a] : e_.real("offset_mm"), area[a]});
    const double stiffness = units::pa_per_kPa * e_.real("stiffness_kPa_per_mm");
    const TimeTable factor = s_.factor_of(e_, TimeTable::ramp(s_.end_s));
    const RigidMotion whole{e_.vector("displacement_mm"), e_.real("radius_change_mm")};
    const RigidShape form = shape();
    const bool round = form.kind == RigidShape::Kind::sphere || form.kind == RigidShape::Kind::cylinder;
    if (whole.growth != 0 && !(round && form.radius + whole.growth > 0))
      e_.fail(fmt::format("radius_change_mm is {}; expected a sphere or cylinder whose radius stays positive",
                          whole.growth));
    auto term = std::make_shared<RigidSurfaceContact>(
        e_.text("name"), form,
        [factor, whole](double t) -> RigidMotion {
          return {factor(t) * whole.displacement, factor(t) * whole.growth};
        },
        std::move(nodes), contact::SurfaceParameters{stiffness, e_.real("friction"), stiffness});
    s_.surfaces[e_.text("name")] = term;
    s_.add_term(e_.text("name"), std::move(term), e_.what());
  }

  void add_body_contact(const BuiltBody& one, const BuiltBody& other) {
    contact::CollisionMesh mesh(s_.system->state.x);
    add_collision_body(mesh, one);
    const bool self = one.name == other.name;
    if (!self) add_collision_body(mesh, other);
    contact::CandidateParameters parameters;
    parameters.modulus_Pa = units::pa_per_kPa * e_.real("modulus_kPa");
    parameters.rest_factor = case_.real("contact.rest_factor");
    parameters.wide_skin_mm = case_.real("contact.wide_skin_mm");
    parameters.near_skin_mm = case_.real("contact.near_skin_mm");
    contact::Candidates candidates(std::move(mesh), parameters);
    if (!self) {
      candidates.set_pair(one.name, one.name, {false});
      candidates.set_pair(other.name, other.name, {false});
    }
    contact::BodyPairSettings pair;
    pair.distance_mm = e_.real("distance_mm");
    pair.friction = e_.real("friction");
    pair.even = pair.friction > 0;  // bumps of the normal forces would be as large as it
    candidates.set_pair(one.name, other.name, pair);
    const auto law = e_.text("law") == "penalty" ? contact::Law::penalty : contact::Law::barrier;
    auto term = std::make_shared<contact::BodyContact>(std::move(candidates), law, e_.real("slip_share"),
                                                       e_.text("name"));
    s_.body_contacts.push_back(term);
    s_.add_term(e_.text("name"), std::move(term), e_.what());
  }

  void add_collision_body(contact::CollisionMesh& mesh, const BuiltBody& body) {
    const int group = static_cast<int>(mesh.bodies().size());
    std::vector<double> radius = body.half_thickness;
    const double distance = e_.real("distance_mm");
    for (double& r : radius) {
      if (!(r > 0)) r = 0.5 * distance;
      if (!(r > 0)) e_.fail(fmt::format("body '{}' has no thickness; expected distance_mm", body.name));
      const double reach = distance > 0 ? distance : 2 * r;
      s_.contact_reach_mm = std::min(s_.contact_reach_mm, reach);
    }
    if (body.kind == Kind::beams)
      mesh.add_beams({body.name, group}, body.at.offset, body.mesh.lines,
                     std::vector<double>(body.mesh.lines.size(), radius.front()));
    else
      mesh.add_shell({body.name, group}, body.at.offset, body.surface(), radius);
  }

  Scene& s_;
  const Case& case_;
  const Entry& e_;
};

}  // namespace

void add_contact(Scene& scene, const Case& file, const Entry& e) {
  Contacts(scene, file, e).add();
}

}  // namespace valsalva::assembly
