// Any System as an immersed body; coupling by element quadrature; periodic boxes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <random>

#include "core/errors.hpp"
#include "coupling/immersed_flow.hpp"
#include "coupling/immersed_structure.hpp"
#include "materials/neo_hookean.hpp"
#include "materials/st_venant_kirchhoff.hpp"
#include "solid_meshes.hpp"
#include "structure/beam.hpp"
#include "structure/shell_term.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::coupling;
using structure::Shape;

Points random_vectors(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Points points(count);
  for (Vec3& p : points)
    for (int d = 0; d < 3; ++d) p[d] = normal(random);
  return points;
}

double dot(const Points& a, const Points& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

Vec3 bent(const Vec3& u) {
  return {3 * u.x() + 0.2 * u.y() * u.y(), 1.5 * u.y(), u.z() + 0.1 * u.x()};
}

class SamplingOfEveryElement : public testing::TestWithParam<Shape> {};

TEST_P(SamplingOfEveryElement, IsAdjointKeepsForceAndConstantsAndItsSpacing) {
  const structure::SolidMesh mesh = structure::solid_box(GetParam(), {2, 2, 1}, bent);
  const double spacing = 0.3;
  Sampling sampling(cells_of(mesh), mesh.reference, spacing);
  Points x = mesh.reference;
  for (Vec3& p : x) p.x() *= 1.7;
  const std::size_t before = sampling.points().size();
  sampling.locate(x);
  EXPECT_GT(sampling.points().size(), before);

  const Points force = random_vectors(x.size(), 1), velocity = random_vectors(sampling.points().size(), 2);
  Points at_points, at_nodes;
  sampling.to_points(force, at_points);
  sampling.to_nodes(velocity, at_nodes);
  ASSERT_EQ(at_points.size(), velocity.size());
  EXPECT_NEAR(dot(at_points, velocity), dot(force, at_nodes), 1e-12 * at_points.size());
  Vec3 difference = Vec3::Zero();
  for (const Vec3& f : force) difference += f;
  for (const Vec3& f : at_points) difference -= f;
  EXPECT_LT(difference.norm(), 1e-11);
  sampling.to_nodes(Points(velocity.size(), Vec3(1, -2, 3)), at_nodes);
  for (const Vec3& u : at_nodes) EXPECT_LT((u - Vec3(1, -2, 3)).norm(), 1e-12);
  // Rigid rotation of the fluid is one of the nodes, and the torque is kept.
  const Vec3 rate(2, -1, 3);
  Points turning;
  for (const Vec3& p : sampling.points()) turning.push_back(rate.cross(p));
  sampling.to_nodes(turning, at_nodes);
  Vec3 torque = Vec3::Zero();
  for (std::size_t a = 0; a < x.size(); ++a) {
    EXPECT_LT((at_nodes[a] - rate.cross(x[a])).norm(), 1e-11) << a;
    torque += x[a].cross(force[a]);
  }
  for (std::size_t q = 0; q < at_points.size(); ++q) torque -= sampling.points()[q].cross(at_points[q]);
  EXPECT_LT(torque.norm(), 1e-10);
  // Every point has another one (within its element or the next) no further than the spacing.
  for (const Vec3& p : sampling.points()) {
    double nearest = 1e9;
    for (const Vec3& q : sampling.points())
      if (&p != &q) nearest = std::min(nearest, (p - q).norm());
    EXPECT_LE(nearest, spacing * (1 + 1e-9));
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, SamplingOfEveryElement,
                         testing::Values(Shape::tet4, Shape::tet10, Shape::hex8, Shape::hex27),
                         [](const auto& info) { return structure::name_of(info.param); });

TEST(Sampling, OfLinesTrianglesAndLoneNodes) {
  const Points x{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 5}, {9, 9, 9}};
  std::vector<Cell> cells = cells_of(std::vector<Triangle>{{0, 1, 2}});
  cells.push_back(cells_of(std::vector<Edge>{{0, 3}}).front());
  const Sampling sampling(cells, x, 0.5);
  EXPECT_EQ(sampling.points().size(), 15u + 10u + 1u);  // sqrt(5) mm: 5 divisions; 5 mm: 10
  EXPECT_EQ(sampling.points().back(), x.back());
  const Points force = random_vectors(x.size(), 3), velocity = random_vectors(sampling.points().size(), 4);
  Points at_points, at_nodes;
  sampling.to_points(force, at_points);
  sampling.to_nodes(velocity, at_nodes);
  EXPECT_NEAR(dot(at_points, velocity), dot(force, at_nodes), 1e-12);
  EXPECT_THROW(Sampling(cells, x, 0), InputError);
}

TEST(Transfer, InPeriodicBoxesAPointActsOnAllImagesAlike) {
  const fluid::Slab slab(MPI_COMM_SELF, {{6, 4, 5}, Vec3(-1, 2, 0), 0.5}, true);
  const Vec3 box(3, 2, 2.5);
  for (const std::string& name : kernel_names()) {
    Transfer transfer(slab, kernel_from(name), {true, true, true});
    Points x = random_vectors(40, 5);
    const Points force = random_vectors(40, 6);
    const auto spread = [&] {
      transfer.locate(x);
      fluid::FaceField density(slab);
      transfer.spread(force, density);
      return density;
    };
    const fluid::FaceField density = spread();
    Points back, shifted;
    transfer.interpolate(density, back);
    double square = 0;
    for (int d = 0; d < 3; ++d) {
      double total = 0;
      for (int k = 0; k < 5; ++k)
        for (int j = 0; j < 4; ++j)
          for (int i = 0; i < 6; ++i) {
            total += 0.125 * density[d](i, j, k);
            square += 0.125 * density[d](i, j, k) * density[d](i, j, k);
          }
      double expected = 0;
      for (const Vec3& f : force) expected += f[d];
      EXPECT_NEAR(total, expected, 1e-11);
    }
    EXPECT_NEAR(dot(force, back), square, 1e-11 * square);  // adjoint
    for (std::size_t a = 0; a < x.size(); ++a)
      x[a] += Vec3((int(a) % 5 - 2) * box.x(), (int(a) % 3 - 1) * box.y(), (int(a) % 7 - 3) * box.z());
    transfer.locate(x);
    transfer.interpolate(density, shifted);
    for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((shifted[a] - back[a]).norm(), 1e-10);
  }
}

fluid::Boundaries periodic_box() {
  fluid::Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {fluid::Side::periodic, fluid::Side::periodic};
  return boundaries;
}

// A soft block, three times as dense as the fluid, in a periodic box.
struct Block {
  fluid::Flow flow{MPI_COMM_SELF, {{12, 12, 12}, Vec3::Zero(), 1.0}, periodic_box(), {}};
  std::shared_ptr<structure::Solid> solid;
  std::unique_ptr<ImmersedFlow> system;
  ImmersedStructure* body = nullptr;

  explicit Block(bool sampled, const Vec3& velocity = Vec3(40, -20, 10)) {
    const structure::SolidMesh mesh = structure::solid_box(Shape::hex8, {3, 3, 2}, [](const Vec3& u) {
      return Vec3(4 + 3 * u.x(), 5 + 3 * u.y(), 10 + 2 * u.z());
    });
    const auto law =
        std::make_shared<materials::SolidLaw>(std::make_shared<materials::StVenantKirchhoff>(2e4, 1e4),
                                              materials::Volumetric{}, materials::Split::full);
    solid = std::make_shared<structure::Solid>(mesh, law, structure::Formulation::displacement);
    auto structure = std::make_unique<structure::System>();
    const structure::Body block = structure->add_body("block", mesh.reference, solid->lumped_mass(3e-3));
    for (std::size_t a = 0; a < structure->nodes(); ++a)  // turning and shearing, too
      structure->state.v[a] =
          velocity + Vec3(0, 0, 20).cross(mesh.reference[a]) + Vec3(5 * mesh.reference[a].y(), 0, 0);
    ImmersedStructureSettings settings;
    settings.cells = cells_of(mesh);
    if (sampled) settings.sampling_mm = 0.5;
    add_excess_mass(*structure, block, 3e-3, 1e-3, settings.excess_mass_g);
    settings.tie_rate_per_s = 2e3;
    auto immersed =
        std::make_unique<ImmersedStructure>(std::move(structure),
                                            std::vector<std::shared_ptr<structure::ForceTerm>>{
                                                std::make_shared<structure::SolidTerm>(solid, block)},
                                            mesh.reference, settings);
    body = immersed.get();
    system = std::make_unique<ImmersedFlow>(flow, std::move(immersed), ImmersedFlowSettings{});
  }
  void run(int steps) {
    for (int n = 0; n < steps; ++n) {
      const ImmersedStep step = system->step(1e-3);
      EXPECT_LT(step.dt_s, step.critical_s);
    }
  }
};

TEST(ImmersedStructure, MomentumOfFluidAndHeavyBodyIsKept) {
  for (bool sampled : {false, true}) {
    Block block(sampled);
    const Vec3 before = block.body->excess_momentum();
    EXPECT_GT(before.norm(), 0);
    block.run(60);
    const Vec3 fluid = block.flow.momentum(), after = block.body->excess_momentum();
    EXPECT_GT(fluid.norm(), 0.1 * before.norm());  // it has been passed on
    EXPECT_LT((fluid + after - before).norm(), 1e-10 * before.norm());
    EXPECT_LT(block.body->largest_slip(), 0.1);
  }
}

TEST(ImmersedStructure, ContinuesBitwise) {
  Block whole(true), resumed(true);
  whole.run(10);
  state::State stored;
  stored.restart = whole.system->save();
  whole.run(20);
  resumed.system->load(stored);
  resumed.run(20);
  const auto a = whole.system->save(), b = resumed.system->save();
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, array] : a) EXPECT_EQ(array.data, b.at(name).data) << name;
}

TEST(ImmersedStructure, TangentProductIsThatOfTheElements) {
  Block block(false);
  block.run(10);
  const std::size_t nodes = block.body->x().size();
  Points direction = random_vectors(block.body->unknowns(), 7), product;
  for (std::size_t a = 0; a < nodes; ++a) direction[nodes + a] = direction[a];  // the ties do not pull
  block.body->update_tangent();
  block.body->tangent_product(direction, product);
  structure::BlockMatrix matrix(nodes, 0);
  block.solid->add_tangent(block.body->x(), matrix);
  Eigen::VectorXd u(3 * nodes);
  for (std::size_t a = 0; a < nodes; ++a) u.segment<3>(3 * a) = direction[a];
  const Eigen::VectorXd expected = matrix.times(u);
  for (std::size_t a = 0; a < nodes; ++a)
    EXPECT_LT((product[a] - expected.segment<3>(3 * a)).norm(), 1e-4 * expected.norm()) << a;
}

TEST(ImmersedStructure, RefusesLightBodiesAndMissingTies) {
  structure::System system;
  const structure::Body body = system.add_body("foam", {{0, 0, 0}}, {1e-6});
  std::vector<double> excess;
  EXPECT_THROW(add_excess_mass(system, body, 0.5e-3, 1e-3, excess), InputError);
  auto pair = std::make_unique<structure::System>();
  pair->add_body("rod", {{0, 0, 0}, {1, 0, 0}}, {1e-6, 1e-6});
  ImmersedStructureSettings settings;
  settings.cells = cells_of(std::vector<Edge>{{0, 1}});
  settings.excess_mass_g = {1e-6, 1e-6};
  const Points reference = pair->state.x;
  EXPECT_THROW(ImmersedStructure(std::move(pair), {}, reference, settings), InputError);
}

// A stretched square of shell: as leaflets, and as a term of a System.
TEST(ImmersedStructure, AShellTermMovesAsTheImmersedShellDoes) {
  structure::ShellMesh mesh;
  const int n = 6;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.reference.emplace_back(3 + i, 3 + j, 6);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  mesh.thickness_mm.assign(mesh.reference.size(), 0.3);
  Points start = mesh.reference;
  for (Vec3& x : start) x = Vec3(6, 6, 6) + 1.1 * (x - Vec3(6, 6, 6)) + Vec3(0, 0, 0.2 * std::sin(x.x()));
  const structure::Shell shell(mesh, std::make_shared<materials::NeoHookean>(2e4), {1e5, 0.5});
  fluid::Flow one(MPI_COMM_SELF, {{12, 12, 12}, Vec3::Zero(), 1.0}, periodic_box(), {}),
      other(MPI_COMM_SELF, {{12, 12, 12}, Vec3::Zero(), 1.0}, periodic_box(), {});
  ImmersedFlow leaflets(one,
                        std::make_unique<ImmersedShell>(MPI_COMM_SELF, shell, start, start,
                                                        std::vector<std::uint8_t>(start.size(), 0),
                                                        std::vector<int>(start.size(), -1), Spacing{}),
                        {});
  auto structure = std::make_unique<structure::System>();
  const structure::Body body = structure->add_body("sheet", start, shell.lumped_mass(1e-3));
  ImmersedStructureSettings settings;
  settings.cells = cells_of(mesh.triangles);
  settings.lead = step_lead;
  settings.least_lead = least_step_lead;
  ImmersedFlow general(
      other,
      std::make_unique<ImmersedStructure>(
          std::move(structure),
          std::vector<std::shared_ptr<structure::ForceTerm>>{
              std::make_shared<structure::ShellTerm>(std::make_shared<structure::Shell>(shell), body)},
          mesh.reference, settings),
      {});
  double critical = 0;
  for (int step = 0; step < 20; ++step) {
    critical = leaflets.step(2e-5).critical_s;
    const ImmersedStep other_step = general.step(2e-5);
    EXPECT_NEAR(other_step.critical_s / critical, 1, 0.02);  // tangents differ where one is clipped
  }
  for (std::size_t a = 0; a < start.size(); ++a)
    EXPECT_LT((leaflets.body()->x()[a] - general.body()->x()[a]).norm(), 1e-12) << a;
  EXPECT_EQ(general.shell(), nullptr);
  EXPECT_EQ(leaflets.shell(), leaflets.body());
}

// A beam held at one end, bent aside and let go in viscous fluid: it is on its way back, losing energy.
TEST(ImmersedStructure, ABentBeamStraightensInFluid) {
  structure::BeamMesh mesh;
  const int n = 12;
  for (int i = 0; i <= n; ++i) mesh.reference.emplace_back(2.5 + 0.5 * i, 6, 6);
  for (int i = 0; i < n; ++i) mesh.elements.push_back({i, i + 1});
  mesh.width_mm.assign(n, 0.5);
  mesh.depth_mm.assign(n, 0.5);
  mesh.depth_axis.assign(n, Vec3::UnitZ());
  const auto network =
      std::make_shared<structure::BeamNetwork>(mesh, structure::BeamMaterial{2e6, 0.3, 1e-3});
  auto structure = std::make_unique<structure::System>();
  Points start = mesh.reference;
  std::vector<Eigen::Quaterniond> rotation;
  for (int i = 0; i <= n; ++i) {
    const double s = 0.5 * i, slope = 0.1 * s / 6;
    start[i].y() += 0.05 * s * s / 6;
    rotation.emplace_back(Eigen::AngleAxisd(slope, Vec3::UnitZ()));
  }
  const structure::Body body = structure->add_rotational_body("beam", start, network->lumped_mass(), rotation,
                                                              network->lumped_inertia());
  structure->hold(0);
  ImmersedStructureSettings settings;
  settings.cells = cells_of(mesh.elements);
  settings.sampling_mm = 0.5;
  settings.rotation_damping_per_s = 1e4;
  auto immersed =
      std::make_unique<ImmersedStructure>(std::move(structure),
                                          std::vector<std::shared_ptr<structure::ForceTerm>>{
                                              std::make_shared<structure::BeamTerm>(network, body)},
                                          mesh.reference, settings);
  ImmersedStructure& beam = *immersed;
  fluid::FlowParameters thick;
  thick.viscosity = 0.1;
  fluid::Boundaries closed;
  for (auto& sides : closed.side) sides = {fluid::Side::slip, fluid::Side::slip};
  fluid::Flow flow(MPI_COMM_SELF, {{12, 12, 12}, Vec3::Zero(), 1.0}, closed, thick);
  ImmersedFlow system(flow, std::move(immersed), {});
  system.step(1e-4);
  const double energy = beam.stored_energy(), tip = beam.x().back().y() - 6;
  EXPECT_GT(tip, 0.2);
  double highest = 0;
  for (double t = 0; t < 0.02;) {
    const ImmersedStep step = system.step(1e-4);
    t += step.dt_s;
    highest = std::max(highest, beam.stored_energy());
    ASSERT_LT(system.steps(), 20000);
  }
  EXPECT_LE(highest, 1.01 * energy);
  EXPECT_LT(beam.stored_energy(), 0.5 * energy);
  EXPECT_LT(beam.x().back().y() - 6, 0.95 * tip);
  EXPECT_GT(beam.x().back().y() - 6, 0);
  EXPECT_EQ(beam.x().front(), start.front());
}

}  // namespace
