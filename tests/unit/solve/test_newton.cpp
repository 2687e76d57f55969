// Newton's method where there is no scale of forces.
#include <gtest/gtest.h>

#include "materials/neo_hookean.hpp"
#include "solid_meshes.hpp"
#include "solve/implicit.hpp"
#include "solve/statics.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

struct Block {
  System system;
  std::vector<std::shared_ptr<ForceTerm>> terms;
  Points reference;

  Block() {
    const SolidMesh mesh = solid_box(Shape::hex8, {3, 2, 2}, [](const Vec3& u) { return Vec3(3 * u); });
    reference = mesh.reference;
    const auto law = std::make_shared<materials::SolidLaw>(
        std::make_shared<materials::NeoHookean>(1e5),
        materials::Volumetric{materials::Volumetric::Form::quadratic, 5e5});
    const auto solid = std::make_shared<Solid>(mesh, law, Formulation::displacement);
    terms.push_back(
        std::make_shared<SolidTerm>(solid, system.add_body("block", reference, solid->lumped_mass(1e-3))));
  }
};

}  // namespace

// No force acts at all: the residual and every force that it could be compared with are round-off.
TEST(Newton, FreeFlightWithUniformVelocity) {
  Block block;
  const Vec3 velocity(300, -200, 150);
  for (Vec3& v : block.system.state.v) v = velocity;
  solve::ImplicitSettings settings;
  settings.step_s = 1e-3;
  solve::ImplicitIntegrator integrator(block.system, block.terms, {}, settings);
  for (int i = 0; i < 10; ++i) integrator.step();
  EXPECT_LE(integrator.iterations(), 20);
  for (std::size_t a = 0; a < block.reference.size(); ++a) {
    EXPECT_LT((block.system.state.x[a] - block.reference[a] - 0.01 * velocity).norm(), 1e-10) << a;
    EXPECT_LT((block.system.state.v[a] - velocity).norm(), 1e-7) << a;
  }
}

// Carried through space by one face: stresses and reactions are round-off at the end.
TEST(Newton, UnloadedBodyCarriedBySupports) {
  Block block;
  solve::Supports supports;
  for (std::size_t a = 0; a < block.reference.size(); ++a)
    if (block.reference[a].x() == 0)
      for (int c = 0; c < 3; ++c)
        supports.move(static_cast<int>(a), c, [c](double t) { return (c + 1) * t; });
  solve::Statics statics(block.system, block.terms, supports);
  statics.advance_to(1);
  EXPECT_EQ(statics.failures(), 0);
  for (std::size_t a = 0; a < block.reference.size(); ++a)
    EXPECT_LT((block.system.state.x[a] - block.reference[a] - Vec3(1, 2, 3)).norm(), 1e-9) << a;
}
