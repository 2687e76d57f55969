// What the verification of solids shares: laws, one solid in one system, tables on the screen.
#pragma once

#include <cstdio>

#include "materials/neo_hookean.hpp"
#include "solid_meshes.hpp"
#include "solve/statics.hpp"
#include "structure/dead_load.hpp"
#include "structure/solid_surface.hpp"

namespace valsalva {

inline std::shared_ptr<const materials::SolidLaw> neo_hookean(double shear_Pa, double bulk_Pa) {
  return std::make_shared<materials::SolidLaw>(
      std::make_shared<materials::NeoHookean>(shear_Pa),
      materials::Volumetric{materials::Volumetric::Form::simo_taylor, bulk_Pa});
}

struct SolidScene {
  structure::System system;
  std::shared_ptr<structure::Solid> solid;
  structure::Body body;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;
  solve::Supports supports;

  SolidScene(const structure::SolidMesh& mesh, std::shared_ptr<const materials::SolidLaw> law,
             structure::Formulation formulation, double density = 1e-3)
      : solid(std::make_shared<structure::Solid>(mesh, std::move(law), formulation)) {
    body = system.add_body("solid", mesh.reference, solid->lumped_mass(density));
    terms.push_back(std::make_shared<structure::SolidTerm>(solid, body));
  }

  template <class Inside>
  void fix_where(int component, const Inside& inside) {
    const Points& x = solid->mesh().reference;
    for (std::size_t a = 0; a < x.size(); ++a)
      if (inside(x[a])) supports.fix(static_cast<int>(a), component);
  }

  int node_at(const Vec3& where) const {
    const Points& x = solid->mesh().reference;
    int best = 0;
    for (std::size_t a = 0; a < x.size(); ++a)
      if ((x[a] - where).norm() < (x[best] - where).norm()) best = static_cast<int>(a);
    return best;
  }

  Vec3 displacement(int node) const { return system.state.x[node] - solid->mesh().reference[node]; }
};

inline std::string kind_name(structure::Shape shape, structure::Formulation formulation) {
  return structure::name_of(shape) +
         (formulation == structure::Formulation::mixed ? " mixed" : " displacement");
}

}  // namespace valsalva
