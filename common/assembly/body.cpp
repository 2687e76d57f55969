#include "assembly/body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "assembly/generate.hpp"
#include "assembly/material.hpp"
#include "assembly/mesh_file.hpp"
#include "assembly/valve_shapes.hpp"
#include "core/errors.hpp"
#include "core/units.hpp"
#include "structure/shell_term.hpp"

namespace valsalva::assembly {
namespace {

class Builder {
 public:
  Builder(const Case& scene, const Case& body, const Points* reference)
      : scene_(scene),
        in_(body),
        reference_(reference),
        what_(fmt::format("{}: [[body]] '{}'", scene.file().string(), text("name"))) {}

  BuiltBody build() {
    if (text("name").empty()) throw InputError("{}: name is missing; expected one", what_);
    BuiltBody b;
    b.name = text("name");
    const std::string& kind = text("kind");
    b.kind = kind == "shell"   ? Kind::shell
             : kind == "solid" ? Kind::solid
             : kind == "beams" ? Kind::beams
                               : Kind::rigid;
    b.density = real("density_g_per_mm3");
    b.velocity = vector("velocity_mm_per_s");
    b.spin = vector("spin_rad_per_s");
    try {
      b.mesh = mesh(b.kind);
      b.imaged = b.mesh.points;
      if (reference_) {
        VALSALVA_ASSERT(reference_->size() == b.mesh.points.size());
        b.mesh.points = *reference_;
      }
      b.half_thickness.assign(b.mesh.points.size(), 0);
      if (b.kind == Kind::shell) make_shell(b);
      if (b.kind == Kind::solid) make_solid(b);
      if (b.kind == Kind::beams) make_beams(b);
      if (b.kind == Kind::rigid) make_rigid(b);
    } catch (const InputError& error) {
      const std::string message = error.what();
      if (message.starts_with(what_)) throw;
      throw InputError("{}: {}", what_, message);
    }
    return b;
  }

 private:
  const std::string& text(const std::string& key) const { return in_.text("body." + key); }
  double real(const std::string& key) const { return in_.real("body." + key); }
  Vec3 vector(const std::string& key) const {
    const auto& v = in_.reals("body." + key);
    return {v[0], v[1], v[2]};
  }
  double positive_real(const std::string& key) const {
    if (!(real(key) > 0)) throw InputError("{}: {} is {}; expected a positive number", what_, key, real(key));
    return real(key);
  }
  std::vector<double> list(const std::string& key, std::size_t length) const {
    const auto& v = in_.reals("body." + key);
    if (v.size() != length)
      throw InputError("{}: {} has {} entries; expected {} for shape = \"{}\", kind = \"{}\"", what_, key,
                       v.size(), length, text("shape"), text("kind"));
    return v;
  }
  std::vector<int> divisions(std::size_t length) const {
    const auto given = list("divisions", length);
    return {given.begin(), given.end()};
  }
  std::array<double, 2> range(const std::string& key) const {
    const auto v = list(key, 2);
    if (!(v[0] < v[1]))
      throw InputError("{}: {} is {} to {}; expected an ascending range", what_, key, v[0], v[1]);
    return {v[0], v[1]};
  }

  BodyMesh mesh(Kind kind) const {
    const std::string& shape = text("shape");
    const auto refuse = [&] {
      throw InputError("{}: shape = \"{}\" does not go with kind = \"{}\"", what_, shape, text("kind"));
    };
    if (shape == "file") {
      if (text("file").empty())
        throw InputError("{}: file is missing; expected a mesh file, or another shape", what_);
      return read_mesh(scene_.resolve(text("file")),
                       kind == Kind::solid   ? Elements::solids
                       : kind == Kind::beams ? Elements::lines
                                             : Elements::triangles,
                       text("group"), real("scale_to_mm"));
    }
    const Frame frame = frame_of(vector("origin_mm"), vector("direction1"), vector("direction2"), what_);
    if (kind == Kind::beams) {
      if (shape == "line")
        return curve(plate_map(frame, {list("size_mm", 1)[0], 0, 0}, 0), divisions(1)[0], sewn());
      if (shape == "arc")
        return curve(cylinder_map(frame, positive_real("radius_mm"), range("angle_deg"), 0, 0),
                     divisions(1)[0], sewn());
      refuse();
    }
    const bool solid = kind == Kind::solid;
    if (shape == "line" || shape == "arc" || (shape == "plate" && solid) ||
        (!solid && (shape == "box" || shape == "ball")))
      refuse();
    const Map map = map_of(frame, shape, solid);
    if (!solid) {
      const auto n = divisions(2);
      return copied(sheet(map, {n[0], n[1]}, pattern(), sewn()), frame);
    }
    const auto n = divisions(3);
    return copied(block(map, {n[0], n[1], n[2]}, element(), sewn()), frame);
  }

  BodyMesh copied(BodyMesh mesh, const Frame& frame) const {
    const int copies = in_.integer("body.copies");
    return copies > 1 ? repeated_round(mesh, frame, copies) : mesh;
  }

  Map map_of(const Frame& frame, const std::string& shape, bool solid) const {
    const auto& ratio = in_.reals("body.grading");
    return graded(plain_map(frame, shape, solid), {ratio[0], ratio[1], ratio[2]});
  }

  Map plain_map(const Frame& frame, const std::string& shape, bool solid) const {
    if (shape == "corners") return corner_map(corners(solid ? 8 : 4));
    if (shape == "ball") return ball_map(frame, positive_real("radius_mm"));
    const double wall = solid && shape != "box" ? positive_real("wall_mm") : 0;
    if (shape == "disc") return disc_map(frame, positive_real("radius_mm"), wall);
    if (shape == "leaflet") return leaflet_map(frame, valve(wall), part());
    if (shape == "crown") return crown_map(frame, valve(wall), part());
    if (shape == "cylinder")
      return cylinder_map(frame, positive_real("radius_mm"), range("angle_deg"), list("size_mm", 1)[0], wall);
    if (shape == "sphere")
      return sphere_map(frame, positive_real("radius_mm"), range("angle_deg"), range("polar_deg"), wall);
    if (shape == "annulus")
      return annulus_map(frame, real("radius_mm"), range("angle_deg"), list("size_mm", 1)[0], wall);
    const auto size = list("size_mm", solid ? 3 : 2);
    return plate_map(frame, {size[0], size[1], solid ? size[2] : 0}, real("twist_deg"));
  }

  bool sewn() const { return in_.boolean("body.sewn"); }
  Points corners(std::size_t count) const {
    const auto v = list("corners_mm", 3 * count);
    Points x;
    for (std::size_t c = 0; c < count; ++c) x.emplace_back(v[3 * c], v[3 * c + 1], v[3 * c + 2]);
    return x;
  }

  ValveShape valve(double wall) const {
    ValveShape v;
    v.radius = positive_real("radius_mm");
    v.height = real("attachment_mm");
    v.post = real("commissure_mm");
    v.gap = real("free_edge_gap_mm");
    v.peak = real("free_edge_peak_mm");
    v.exponent = real("attachment_exponent");
    v.edge_exponent = real("free_edge_exponent");
    v.half_angle_deg = real("leaflet_half_angle_deg");
    v.base = real("base_mm");
    v.wall = wall;
    check_valve(v, what_);
    return v;
  }
  std::array<double, 2> part() const { return range("leaflet_part"); }

  Pattern pattern() const {
    const std::string& p = text("pattern");
    return p == "right"     ? Pattern::right
           : p == "left"    ? Pattern::left
           : p == "crossed" ? Pattern::crossed
                            : Pattern::alternating;
  }
  structure::Shape element() const {
    using structure::Shape;
    const std::string& e = text("element");
    return e == "tet4"    ? Shape::tet4
           : e == "tet10" ? Shape::tet10
           : e == "hex27" ? Shape::hex27
                          : Shape::hex8;
  }

  /// Of each node of a shell.
  std::vector<double> thickness(const BodyMesh& mesh) const {
    const auto& grid = in_.reals("body.thickness_grid_mm");
    if (!grid.empty()) return thickness_on_grid(mesh, grid);
    if (text("thickness_field").empty())
      return std::vector<double>(mesh.points.size(), positive_real("thickness_mm"));
    const auto field = mesh.fields.find(text("thickness_field"));
    if (field == mesh.fields.end())
      throw InputError("{}: thickness_field '{}' is not in the mesh file (node data with one component)",
                       what_, text("thickness_field"));
    for (std::size_t a = 0; a < field->second.size(); ++a)
      if (!(field->second[a] > 0))
        throw InputError("{}: thickness_field '{}' is {} at node {}; expected a positive thickness in mm",
                         what_, field->first, field->second[a], a);
    return field->second;
  }

  std::vector<double> thickness_on_grid(const BodyMesh& mesh, const std::vector<double>& values) const {
    const auto count = list("thickness_grid", 2);
    const std::array<int, 2> n{static_cast<int>(count[0]), static_cast<int>(count[1])};
    if (!mesh.fields.contains("grid2"))
      throw InputError("{}: thickness_grid_mm needs a generated sheet; expected shape other than \"{}\"",
                       what_, text("shape"));
    if (n[0] < 2 || n[1] < 2 || values.size() != static_cast<std::size_t>(n[0]) * n[1])
      throw InputError(
          "{}: thickness_grid_mm has {} values; expected thickness_grid = {} x {}, at least 2 x 2", what_,
          values.size(), n[0], n[1]);
    std::vector<double> t;
    for (std::size_t a = 0; a < mesh.points.size(); ++a)
      t.push_back(bilinear(values, n, mesh.fields.at("grid1")[a], mesh.fields.at("grid2")[a]));
    return t;
  }

  void make_shell(BuiltBody& b) const {
    structure::ShellMesh mesh;
    mesh.reference = b.mesh.points;
    mesh.triangles = b.mesh.triangles;
    mesh.thickness_mm = thickness(b.mesh);
    Points middle, normal;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 &p = mesh.reference[t[0]], &q = mesh.reference[t[1]], &r = mesh.reference[t[2]];
      middle.push_back((p + q + r) / 3);
      normal.push_back((q - p).cross(r - p).normalized());
    }
    const materials::MaterialSet material = material_of(in_, what_);
    const FibreFields fibres = fibres_of(in_, material, middle, normal, what_);
    mesh.fibre1 = fibres.first;
    mesh.fibre2 = fibres.second;
    mesh.stiffness_factor.assign(mesh.triangles.size(), real("stiffness_factor"));
    const auto law = material.plane_law();
    const RestModuli rest = moduli_at_rest(*law, !mesh.fibre1.empty());
    for (std::size_t a = 0; a < mesh.thickness_mm.size(); ++a)
      b.half_thickness[a] = 0.5 * mesh.thickness_mm[a];
    b.bending_Pa = real("bending_scale") * rest.young_Pa;
    b.bending_poisson = rest.poisson;
    if (text("shell_element") == "kirchhoff") {
      const structure::SectionScales scales{real("membrane_scale"), std::cbrt(real("bending_scale"))};
      b.section = text("law") == "linear" ? structure::koiter_section(rest.young_Pa, rest.poisson, scales)
                                          : structure::law_section(law, 3, scales);
      b.shell_mesh = std::move(mesh);
      return;
    }
    b.shell = std::make_shared<structure::Shell>(std::move(mesh), scaled(law, real("membrane_scale")),
                                                 structure::Bending{b.bending_Pa, b.bending_poisson});
  }

  void make_solid(BuiltBody& b) const {
    structure::SolidMesh mesh;
    mesh.reference = b.mesh.points;
    mesh.offsets.push_back(0);
    Points middle;
    for (const SolidCell& cell : b.mesh.solids) {
      mesh.add(cell.shape, cell.nodes);
      Vec3 sum = Vec3::Zero();
      for (int a : cell.nodes) sum += b.mesh.points[a];
      middle.push_back(sum / cell.nodes.size());
    }
    const materials::MaterialSet material = material_of(in_, what_);
    const Vec3 third = in_.text("body.fibres") == "cylindrical"
                           ? Vec3(Vec3::Zero())
                           : Vec3(vector("direction1").cross(vector("direction2")).normalized());
    const FibreFields fibres = fibres_of(in_, material, middle, Points(middle.size(), third), what_);
    mesh.fibre1 = fibres.first;
    mesh.fibre2 = fibres.second;
    mesh.stiffness_factor.assign(mesh.shapes.size(), real("stiffness_factor"));
    const auto law = std::make_shared<materials::SolidLaw>(material.solid_law());
    if (!law->resists_volume_change() && !scene_.has("fluid"))  // the fluid inside keeps it
      throw InputError(
          "{}: law '{}' resists no change of volume: found volumetric = \"none\", split = \"modified\"; "
          "expected volumetric = \"j-ln-j\" (or another form) with bulk_modulus_kPa, or split = \"full\"",
          what_, material.law);
    const bool displacement = text("formulation") == "displacement" ||
                              material.volumetric.form == materials::Volumetric::Form::none;
    b.solid = std::make_shared<structure::Solid>(
        std::move(mesh), law,
        displacement ? structure::Formulation::displacement : structure::Formulation::mixed);
  }

  /// Of each beam.
  Points depth_axes(const BodyMesh& mesh) const {
    const Vec3 given = vector("depth_direction");
    Points axes(mesh.lines.size(), given);
    if (text("depth") == "constant") return axes;
    if (!(given.norm() > 0)) throw InputError("{}: depth_direction is zero; expected an axis", what_);
    const Vec3 axis = given.normalized(), point = vector("depth_point_mm");
    for (std::size_t e = 0; e < axes.size(); ++e) {
      const Vec3 d = 0.5 * (mesh.points[mesh.lines[e][0]] + mesh.points[mesh.lines[e][1]]) - point;
      axes[e] = d - axis.dot(d) * axis;
      if (!(axes[e].norm() > 0))
        throw InputError("{}: depth = \"radial\", but beam {} lies on the axis", what_, e);
      axes[e].normalize();
    }
    return axes;
  }

  void make_beams(BuiltBody& b) const {
    structure::BeamMesh mesh;
    mesh.reference = b.mesh.points;
    mesh.elements = b.mesh.lines;
    const double width = positive_real("width_mm"), depth = positive_real("depth_mm");
    mesh.width_mm.assign(mesh.elements.size(), width);
    mesh.depth_mm.assign(mesh.elements.size(), depth);
    mesh.depth_axis = depth_axes(b.mesh);
    if (real("torsion_mm4") > 0) mesh.torsion_mm4.assign(mesh.elements.size(), real("torsion_mm4"));
    if (real("shear_area_mm2") > 0) mesh.shear_area_mm2.assign(mesh.elements.size(), real("shear_area_mm2"));
    b.half_thickness.assign(b.mesh.points.size(), 0.5 * std::min(width, depth));
    structure::BeamMaterial material;
    material.density_g_per_mm3 = b.density;
    material.superelastic = superelastic_of(in_, what_);
    if (material.superelastic) {
      const auto& grid = in_.reals("body.fibre_grid");
      material.fibres = {static_cast<int>(grid[0]), static_cast<int>(grid[1]), static_cast<int>(grid[2])};
    } else {
      if (!text("material").empty() || (!text("law").empty() && text("law") != "linear"))
        throw InputError(
            "{}: found material '{}' and law '{}'; expected young_kPa, or law = \"superelastic\"", what_,
            text("material"), text("law"));
      material.young_Pa = positive_real("young_kPa") * units::pa_per_kPa;
      material.poisson = real("poisson");
    }
    b.beams = std::make_shared<structure::BeamNetwork>(std::move(mesh), material);
  }

  void make_rigid(BuiltBody& b) const {
    b.half_thickness.assign(b.mesh.points.size(), 0.5 * real("thickness_mm"));
    if (text("motion") == "fixed") return;
    const auto& centre = in_.reals("body.centre_mm");
    const auto& inertia = in_.reals("body.inertia_g_mm2");
    structure::RigidProperties p;
    if (real("mass_g") > 0 && !centre.empty() && !inertia.empty()) {
      p.mass_g = real("mass_g");
    } else {
      p = structure::properties_of(b.mesh.points, b.mesh.triangles, b.density, what_);
      if (real("mass_g") > 0) {
        p.inertia *= real("mass_g") / p.mass_g;
        p.mass_g = real("mass_g");
      }
    }
    if (!centre.empty()) {
      const auto c = list("centre_mm", 3);
      p.centre = {c[0], c[1], c[2]};
    }
    if (!inertia.empty()) {
      const auto i = list("inertia_g_mm2", 6);
      p.inertia << i[0], i[3], i[5], i[3], i[1], i[4], i[5], i[4], i[2];
    }
    b.free = p;
  }

  const Case& scene_;
  const Case& in_;
  const Points* reference_;
  std::string what_;
};

/// An outer face of a solid as triangles over its nodes.
void add_triangles(const structure::SolidFace& face, std::vector<Triangle>& out) {
  const std::vector<int>& n = face.nodes;
  using structure::Shape;
  if (face.shape == Shape::triangle3) out.push_back({n[0], n[1], n[2]});
  if (face.shape == Shape::quad4) {
    out.push_back({n[0], n[1], n[2]});
    out.push_back({n[0], n[2], n[3]});
  }
  if (face.shape == Shape::triangle6)
    for (const Triangle& t : {Triangle{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
      out.push_back({n[t[0]], n[t[1]], n[t[2]]});
  if (face.shape == Shape::quad9)
    for (int corner = 0; corner < 4; ++corner) {
      const int before = n[4 + (corner + 3) % 4], after = n[4 + corner];
      out.push_back({n[corner], after, n[8]});
      out.push_back({n[corner], n[8], before});
    }
}

}  // namespace

BuiltBody build_body(const Case& scene, const Case& body, const Points* reference) {
  return Builder(scene, body, reference).build();
}

void complete_shell(BuiltBody& body, const structure::EdgeConditions& edges) {
  if (body.shell_mesh)
    body.kirchhoff =
        std::make_shared<structure::KirchhoffShell>(*std::move(body.shell_mesh), body.section, edges);
}

std::vector<Triangle> BuiltBody::surface() const {
  if (kind != Kind::solid) return mesh.triangles;
  std::vector<Triangle> triangles;
  for (const auto& face : structure::boundary_faces(solid->mesh())) add_triangles(face, triangles);
  return triangles;
}

std::vector<Edge> BuiltBody::border() const {
  if (kind == Kind::beams) return mesh.lines;
  std::vector<Edge> edges;
  for (const auto& [element, place] : border_edges(mesh.triangles))
    edges.push_back({mesh.triangles[element][place], mesh.triangles[element][(place + 1) % 3]});
  return edges;
}

std::vector<double> BuiltBody::surface_area() const {
  std::vector<double> area(mesh.points.size(), 0.0);
  for (const Triangle& t : surface()) {
    const Vec3 &p = mesh.points[t[0]], &q = mesh.points[t[1]], &r = mesh.points[t[2]];
    for (int a : t) area[a] += (q - p).cross(r - p).norm() / 6;
  }
  if (kind == Kind::beams)
    for (std::size_t e = 0; e < mesh.lines.size(); ++e)
      for (int a : mesh.lines[e])
        area[a] += 0.5 * beams->mesh().width_mm[e] *
                   (mesh.points[mesh.lines[e][1]] - mesh.points[mesh.lines[e][0]]).norm();
  return area;
}

std::vector<double> BuiltBody::mass() const {
  switch (kind) {
    case Kind::shell:
      return kirchhoff ? kirchhoff->lumped_mass(density) : shell->lumped_mass(density);
    case Kind::solid:
      return solid->lumped_mass(density);
    case Kind::beams:
      return beams->lumped_mass();
    case Kind::rigid:
      break;
  }
  // Held: no mass takes part in the motion; a free body's is shared out for the sums over nodes.
  return std::vector<double>(mesh.points.size(), free ? free->mass_g / mesh.points.size() : density);
}

std::shared_ptr<structure::ForceTerm> add_to_system(BuiltBody& b, structure::System& system) {
  if (b.kind == Kind::beams)
    b.at = system.add_rotational_body(
        b.name, b.mesh.points, b.mass(),
        std::vector<Eigen::Quaterniond>(b.mesh.points.size(), Eigen::Quaterniond::Identity()),
        b.beams->lumped_inertia());
  else
    b.at = system.add_body(b.name, b.mesh.points, b.mass());
  if (b.kind == Kind::rigid) {
    for (int a = b.at.begin(); a < b.at.end(); ++a) system.hold(a);
    if (b.free) {
      b.rigid = std::make_shared<structure::RigidBody>(system, b.at, *b.free);
      b.rigid->set_velocity(b.velocity, b.spin);
    }
    return nullptr;
  }
  Vec3 centre = Vec3::Zero();
  double mass = 0;
  for (int a = b.at.begin(); a < b.at.end(); ++a) {
    centre += system.mass(a) * system.state.x[a];
    mass += system.mass(a);
  }
  centre /= mass;
  for (int a = b.at.begin(); a < b.at.end(); ++a) {
    system.state.v[a] = b.velocity + b.spin.cross(system.state.x[a] - centre);
    if (const int r = system.rotation_of(a); r >= 0) system.state.angular_velocity[r] = b.spin;
  }
  if (b.shell) return std::make_shared<structure::ShellTerm>(b.shell, b.at);
  if (b.kirchhoff) {
    auto term = std::make_shared<structure::KirchhoffTerm>(b.kirchhoff, b.at);
    if (b.clamps) term->set_clamps(b.clamps);
    return term;
  }
  if (b.beams) return std::make_shared<structure::BeamTerm>(b.beams, b.at);
  if (b.solid) return std::make_shared<structure::SolidTerm>(b.solid, b.at);
  return nullptr;
}

}  // namespace valsalva::assembly
