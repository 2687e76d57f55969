#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <numeric>

#include "assembly/generate.hpp"
#include "assembly/mesh_file.hpp"
#include "assembly/select.hpp"
#include "core/errors.hpp"
#include "materials/neo_hookean.hpp"
#include "structure/solid.hpp"
#include "temporary_folder.hpp"

using namespace valsalva;
using namespace valsalva::assembly;
using structure::Shape;

namespace {

Vec3 area_vector(const BodyMesh& m) {
  Vec3 sum = Vec3::Zero();
  for (const Triangle& t : m.triangles)
    sum += 0.5 * (m.points[t[1]] - m.points[t[0]]).cross(m.points[t[2]] - m.points[t[0]]);
  return sum;
}

/// Enclosed volume of a closed surface, positive when outward.
double volume(const BodyMesh& m) {
  double sum = 0;
  for (const Triangle& t : m.triangles) sum += m.points[t[0]].dot(m.points[t[1]].cross(m.points[t[2]])) / 6;
  return sum;
}

double solid_volume(const BodyMesh& m) {
  structure::SolidMesh mesh;
  mesh.reference = m.points;
  for (const SolidCell& cell : m.solids) mesh.add(cell.shape, cell.nodes);
  const auto law = std::make_shared<materials::SolidLaw>(
      std::make_shared<materials::NeoHookean>(1e3),
      materials::Volumetric{materials::Volumetric::Form::quadratic, 1e4}, materials::Split::modified);
  return structure::Solid(mesh, law, structure::Formulation::displacement).volume();
}

}  // namespace

TEST(Generate, PlateCoversItsAreaWithAnyPattern) {
  const Frame frame = frame_of({1, 2, 3}, {0, 2, 0}, {1, 1, 0}, "test");
  for (Pattern p : {Pattern::alternating, Pattern::right, Pattern::left, Pattern::crossed}) {
    const BodyMesh m = sheet(plate_map(frame, {4, 3, 0}, 0), {5, 7}, p);
    EXPECT_EQ(m.triangles.size(), p == Pattern::crossed ? 140u : 70u);
    EXPECT_LT((area_vector(m) - 12 * frame.axes.col(2)).norm(), 1e-12);
    EXPECT_EQ(m.groups.at("start1").size(), 8u);
    EXPECT_EQ(m.groups.at("end2").size(), 6u);
  }
}

TEST(Generate, ClosedSphereIsSewnAndOutward) {
  const BodyMesh m = sheet(sphere_map(Frame{}, 2, {0, 360}, {0, 180}, 0), {64, 32}, Pattern::alternating);
  EXPECT_NEAR(volume(m), 4.0 / 3 * M_PI * 8, 0.01 * 33);
  EXPECT_LT(area_vector(m).norm(), 1e-10);
  // Euler: V - E + F = 2 with E = 3F/2.
  EXPECT_EQ(static_cast<long>(m.points.size()) - static_cast<long>(m.triangles.size()) / 2, 2);
}

TEST(Generate, CylinderClosesAndPointsOutward) {
  const BodyMesh m = sheet(cylinder_map(Frame{}, 3, {0, 360}, 5, 0), {40, 6}, Pattern::right);
  EXPECT_EQ(m.points.size(), 40u * 7);
  double flux = 0;
  for (const Triangle& t : m.triangles) {
    const Vec3 n = (m.points[t[1]] - m.points[t[0]]).cross(m.points[t[2]] - m.points[t[0]]);
    flux += n.dot(Vec3(m.points[t[0]].x(), m.points[t[0]].y(), 0));
  }
  EXPECT_GT(flux, 0);
}

TEST(Generate, SolidBlocksHaveTheVolumeOfTheBox) {
  for (Shape s : {Shape::tet4, Shape::tet10, Shape::hex8, Shape::hex27}) {
    const BodyMesh m = block(graded(plate_map(Frame{}, {2, 3, 4}, 0), {3, 1, 0.5}), {2, 3, 2}, s);
    EXPECT_NEAR(solid_volume(m), 24, 1e-10) << structure::name_of(s);
  }
}

TEST(Generate, QuadraticTubeIsCurved) {
  const double exact = M_PI * (4 - 1) * 2 / 4;
  const Map map = cylinder_map(Frame{}, 1, {0, 90}, 2, 1);
  const double linear = solid_volume(block(map, {4, 2, 2}, Shape::hex8));
  const double quadratic = solid_volume(block(map, {4, 2, 2}, Shape::hex27));
  EXPECT_GT(std::abs(linear - exact), 0.02 * exact);
  EXPECT_LT(std::abs(quadratic - exact), 1e-4 * exact);
}

TEST(Generate, RefusesParallelDirections) {
  EXPECT_THROW(frame_of({0, 0, 0}, {1, 0, 0}, {-2, 0, 0}, "body"), InputError);
  EXPECT_THROW(frame_of({0, 0, 0}, {0, 0, 0}, {0, 1, 0}, "body"), InputError);
}

TEST(Select, ByPlace) {
  const Points x{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  Selection s;
  s.place = Place::plane;
  EXPECT_EQ(select(x, s), (std::vector<int>{0, 1, 2}));
  s.point = {0, 0, 1};
  EXPECT_TRUE(select(x, s).empty());
  s.inside = true;
  EXPECT_EQ(select(x, s), (std::vector<int>{0, 1, 2}));
  s = {};
  s.place = Place::sphere;
  s.radius = 2;
  EXPECT_EQ(select(x, s), (std::vector<int>{2}));
  s.inside = true;
  EXPECT_EQ(select(x, s), (std::vector<int>{0, 1, 2}));
  s = {};
  s.place = Place::cylinder;
  s.direction = {0, 0, 5};
  s.radius = 1;
  EXPECT_EQ(select(x, s), (std::vector<int>{1}));
  s = {};
  s.low = {-1, -1, -1};
  s.high = {1, 1, 1};
  EXPECT_EQ(select(x, s), (std::vector<int>{0, 1}));
  s.place = Place::nearest;
  s.point = {0, 0, 2};
  EXPECT_EQ(select(x, s), (std::vector<int>{3}));
}

TEST(MeshFile, GmshTwoWithGroupsAndAField) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "two.msh") << R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "rim"
2 2 "sheet"
$EndPhysicalNames
$Nodes
5
10 0 0 0
20 1 0 0
30 1 1 0
40 0 1 0
50 9 9 9
$EndNodes
$Elements
3
1 1 2 1 1 10 20
2 2 2 2 2 10 20 30
3 2 2 2 2 10 30 40
$EndElements
$NodeData
1
"thickness"
1
0.0
3
0
1
4
10 0.1
20 0.2
30 0.3
40 0.4
$EndNodeData
)";
  const BodyMesh m = read_mesh(folder / "two.msh", Elements::triangles, "sheet", 10);
  ASSERT_EQ(m.points.size(), 4u);  // the loose node is dropped
  EXPECT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(m.points[2], Vec3(10, 10, 0));
  EXPECT_EQ(m.groups.at("rim"), (std::vector<int>{0, 1}));
  EXPECT_EQ(m.fields.at("thickness"), (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(read_mesh(folder / "two.msh", Elements::lines, "", 1).lines.size(), 1u);
  EXPECT_THROW(read_mesh(folder / "two.msh", Elements::solids, "", 1), InputError);
  EXPECT_THROW(read_mesh(folder / "two.msh", Elements::triangles, "shet", 1), InputError);
}

TEST(MeshFile, GmshFourWithAQuadraticTetrahedron) {
  const test::TemporaryFolder folder;
  // gmsh's own order: the last two mid-side nodes are those of the edges 2-3 and 1-3.
  std::ofstream(folder / "four.msh") << R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 0 1
1 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
1 10 1 10
3 1 0 10
1
2
3
4
5
6
7
8
9
10
0 0 0
1 0 0
0 1 0
0 0 1
0.5 0 0
0.5 0.5 0
0 0.5 0
0 0 0.5
0 0.5 0.5
0.5 0 0.5
$EndNodes
$Elements
1 1 1 1
3 1 11 1
1 1 2 3 4 5 6 7 8 9 10
$EndElements
)";
  const BodyMesh m = read_mesh(folder / "four.msh", Elements::solids, "", 1);
  ASSERT_EQ(m.solids.size(), 1u);
  EXPECT_NEAR(solid_volume(m), 1.0 / 6, 1e-12);
  const auto own = structure::node_coordinates(Shape::tet10);
  for (int n = 0; n < 10; ++n) EXPECT_LT((m.points[m.solids[0].nodes[n]] - own[n]).norm(), 1e-12) << n;
}

TEST(MeshFile, SurfacesAndBadFiles) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "square.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  EXPECT_EQ(read_mesh(folder / "square.obj", Elements::triangles, "", 1).triangles.size(), 2u);
  std::ofstream(folder / "two.stl")
      << "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
         "0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\n"
         "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
  EXPECT_EQ(read_mesh(folder / "two.stl", Elements::triangles, "", 1).points.size(), 4u);
  EXPECT_THROW(read_mesh(folder / "square.obj", Elements::lines, "", 1), InputError);
  EXPECT_THROW(read_mesh(folder / "none.msh", Elements::triangles, "", 1), InputError);
  std::ofstream(folder / "bad.msh") << "$MeshFormat\n4.1 0 8\n$EndMesh";
  EXPECT_THROW(read_mesh(folder / "bad.msh", Elements::triangles, "", 1), InputError);
  std::ofstream(folder / "mesh.step") << "x";
  EXPECT_THROW(read_mesh(folder / "mesh.step", Elements::triangles, "", 1), InputError);
}
