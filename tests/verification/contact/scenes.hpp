// An elastic block above held floors, in contact with friction.
#pragma once

#include <cstdio>

#include "contact/body_contact.hpp"
#include "contact/intersections.hpp"
#include "materials/solid_law.hpp"
#include "materials/st_venant_kirchhoff.hpp"
#include "solid_meshes.hpp"
#include "structure/dead_load.hpp"
#include "structure/integrator.hpp"
#include "structure/solid_surface.hpp"

namespace valsalva::contact {

inline std::shared_ptr<const materials::SolidLaw> hookean(double young, double nu) {
  const double mu = young / (2 * (1 + nu)), lambda = young * nu / ((1 + nu) * (1 - 2 * nu));
  return std::make_shared<materials::SolidLaw>(std::make_shared<materials::StVenantKirchhoff>(lambda, mu),
                                               materials::Volumetric{}, materials::Split::full);
}

/// Two triangles a quadrilateral.
inline std::vector<Triangle> triangles_of(const std::vector<structure::SolidFace>& faces) {
  std::vector<Triangle> triangles;
  for (const auto& f : faces) {
    triangles.push_back({f.nodes[0], f.nodes[1], f.nodes[2]});
    if (f.nodes.size() == 4) triangles.push_back({f.nodes[0], f.nodes[2], f.nodes[3]});
  }
  return triangles;
}

inline bool everywhere(const Vec3&) {
  return true;
}

struct BlockScene {
  static constexpr double h = 0.05;  // contact distance
  structure::System system;
  std::shared_ptr<structure::Solid> solid;
  structure::Body block;
  std::vector<structure::Body> floors;
  std::shared_ptr<BodyContact> contact;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;

  /// A block of side x side x height on the floor z = 0 (and below a ceiling at height + 2 gap, when there is
  /// one), `gap` above it. The floor reaches to +-reach in n cells a side, whose edges do not fit the
  /// block's.
  BlockScene(double side, double height, std::array<int, 3> cells, double young, double gap, double friction,
             double modulus, bool ceiling, double reach, int n = 7) {
    const auto mesh = structure::solid_box(structure::Shape::hex8, cells, [&](const Vec3& u) -> Vec3 {
      return Vec3(side * (u.x() - 0.5), side * (u.y() - 0.5), gap + height * u.z());
    });
    solid =
        std::make_shared<structure::Solid>(mesh, hookean(young, 0.3), structure::Formulation::displacement);
    block = system.add_body("block", mesh.reference, solid->lumped_mass(1e-3));
    std::vector<double> levels{0};
    if (ceiling) levels.push_back(height + 2 * gap);
    std::vector<std::vector<Triangle>> plates;
    for (double z : levels) {
      Points x;
      std::vector<Triangle> triangles;
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) x.emplace_back(reach * (2.0 * i / n - 1), reach * (2.0 * j / n - 1), z);
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const int a = j * (n + 1) + i;
          triangles.push_back({a, a + 1, a + n + 2});
          triangles.push_back({a, a + n + 2, a + n + 1});
        }
      floors.push_back(system.add_body(z == 0 ? "floor" : "ceiling", x, std::vector<double>(x.size(), 1e-3)));
      plates.push_back(triangles);
      for (int a = floors.back().begin(); a < floors.back().end(); ++a) system.hold(a);
    }
    CollisionMesh all(system.state.x);
    all.add_shell({"block", 0}, block.offset, triangles_of(structure::faces_where(mesh, everywhere)),
                  std::vector<double>(block.count, 0.5 * h));
    for (std::size_t f = 0; f < floors.size(); ++f)
      all.add_shell({floors[f].name, 1 + int(f)}, floors[f].offset, plates[f],
                    std::vector<double>(floors[f].count, 0.5 * h));
    Candidates candidates(std::move(all), {modulus, 0.9, 0.3, 0.05});
    candidates.set_pair("block", "block", {false});
    for (const auto& floor : floors) {
      candidates.set_pair(floor.name, floor.name, {false});
      candidates.set_pair("block", floor.name, {true, 0, 0, friction, true});
    }
    contact = std::make_shared<BodyContact>(std::move(candidates), Law::barrier);
    terms = {std::make_shared<structure::SolidTerm>(solid, block), contact};
  }

  void gravity(const Vec3& g) {
    terms.push_back(std::make_shared<structure::DeadLoadTerm>(
        "gravity", structure::weight_of(system, block, g), Points{}, [](double) { return 1.0; }));
  }
  double mass() const {
    double sum = 0;
    for (int a = block.begin(); a < block.end(); ++a) sum += system.mass(a);
    return sum;
  }
  Vec3 centre() const { return mean(system.state.x); }
  Vec3 velocity() const { return mean(system.state.v); }
  void set_velocity(const Vec3& v) {
    for (int a = block.begin(); a < block.end(); ++a) system.state.v[a] = v;
  }
  void add_velocity(const Vec3& v) {
    for (int a = block.begin(); a < block.end(); ++a) system.state.v[a] += v;
  }

 private:
  Vec3 mean(const Points& of) const {
    Vec3 sum = Vec3::Zero();
    for (int a = block.begin(); a < block.end(); ++a) sum += system.mass(a) * of[a];
    return sum / mass();
  }
};

}  // namespace valsalva::contact
