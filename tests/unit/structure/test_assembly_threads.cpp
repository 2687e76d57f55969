// Tangents and forces have the same bits on one thread and on three.
#include <gtest/gtest.h>
#include <omp.h>

#include "materials/neo_hookean.hpp"
#include "meshes.hpp"
#include "solid_meshes.hpp"
#include "structure/kirchhoff_shell.hpp"
#include "structure/solid.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

template <class Body>
void expect_same_bits(const Body& body, const Points& x) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  BlockMatrix one(x.size(), 0);
  body.add_tangent(x, one);
  omp_set_num_threads(3);
  BlockMatrix three(x.size(), 0);
  body.add_tangent(x, three);
  omp_set_num_threads(before);
  for (int i = 0; i < one.slots(); ++i) {
    ASSERT_EQ(one.row(i).columns, three.row(i).columns);
    for (std::size_t k = 0; k < one.row(i).blocks.size(); ++k)
      ASSERT_TRUE(one.row(i).blocks[k] == three.row(i).blocks[k]) << i << " " << one.row(i).columns[k];
  }
}

}  // namespace

TEST(AssemblyThreads, HingeShell) {
  const ShellMesh mesh = rectangle(10, 8, 20, 16, 0.4);  // more than one batch
  const Shell shell(mesh, std::make_shared<materials::NeoHookean>(3e5), Bending{9e5, 0.5});
  expect_same_bits(shell, shaken(mesh.reference, 0.05, 1));
}

TEST(AssemblyThreads, KirchhoffShell) {
  const ShellMesh mesh = rectangle(10, 8, 20, 16, 0.4);
  const KirchhoffShell shell(mesh, koiter_section(1e6, 0.3), {});
  expect_same_bits(shell, shaken(mesh.reference, 0.05, 2));
}

TEST(AssemblyThreads, Solids) {
  const auto law = std::make_shared<materials::SolidLaw>(
      std::make_shared<materials::NeoHookean>(1e5),
      materials::Volumetric{materials::Volumetric::Form::quadratic, 1e7});
  for (const Shape shape : {Shape::hex8, Shape::tet4}) {
    const SolidMesh mesh = solid_box(shape, {8, 8, 6}, [](const Vec3& u) { return Vec3(8 * u); });
    expect_same_bits(Solid(mesh, law, Formulation::mixed), shaken(mesh.reference, 0.03, 3));
  }
}
