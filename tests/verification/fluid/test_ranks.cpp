// One and two ranks give the same flow. Started by mpirun with two (or more) ranks: the world's communicator
// runs the distributed flow, every rank alone runs the same one on MPI_COMM_SELF.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

double rough(int d, const Vec3& x) {
  return 60 * std::sin(1.3 * x[(d + 1) % 3] + d) * std::cos(0.7 * x[d] - 0.4 * d);
}

struct Scene {
  const char* name;
  Side x, y, low, high;
  bool tube;
  int order = 2;
  bool thinning = false;  // Carreau-Yasuda blood and a subgrid model
  bool smooth = false;    // interpolated wall of a tilted tube
  bool upwind = false;    // first-order upwinding beside walls
};

void PrintTo(const Scene& scene, std::ostream* out) {
  *out << scene.name;
}

std::unique_ptr<Flow> make(MPI_Comm comm, const Scene& scene) {
  Grid grid;
  grid.cells = {20, 18, 39};
  grid.origin = Vec3(-5, -4.5, -10);
  grid.h = 0.5;
  Boundaries boundaries;
  boundaries.side = {{{scene.x, scene.x}, {scene.y, scene.y}, {scene.low, scene.high}}};
  FlowParameters parameters;
  parameters.order = scene.order;
  if (scene.order == 4) parameters.convection = Convection::centred4;
  if (scene.smooth) parameters.wall = Wall::interpolated;
  parameters.wall_upwind = scene.upwind;
  if (scene.thinning) parameters.extra_viscosity = {.carreau_yasuda = CarreauYasuda{}, .vreman = 0.07};
  auto flow = std::make_unique<Flow>(comm, grid, boundaries, parameters);
  if (scene.tube) {
    const double tilt = scene.smooth ? 0.07 : 0;
    flow->solids().set_lumen([=](const Vec3& x) { return std::hypot(x[0] - tilt * x[2], x[1]) - 4; });
    const int body = flow->solids().add_body("strut");
    flow->solids().mark_segments(body, {Vec3(-4, 0, -1), Vec3(4, 1, 1)}, {{0, 1}}, 0.5);
  }
  flow->set_velocity(rough);
  if (scene.low == Side::inflow)
    flow->set_inflow_rate(
        End::low, [](const Vec3&) { return 1.0; }, 3000);
  return flow;
}

void advance(Flow& flow, int from, int to) {
  for (int step = from; step < to; ++step) {
    flow.set_end_pressure(End::low, 2000 * std::sin(0.1 * step));
    flow.step(5e-5 * (1 + 0.3 * std::sin(step)));
  }
}

double largest_difference(const state::Array& a, const state::Array& b) {
  const auto &p = a.doubles("a"), &q = b.doubles("b");
  EXPECT_EQ(a.shape, b.shape);
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    difference = std::max(difference, std::abs(p[i] - q[i]));
    largest = std::max(largest, std::abs(q[i]));
  }
  return largest > 0 ? difference / largest : difference;
}

class Ranks : public testing::TestWithParam<Scene> {};

TEST_P(Ranks, GiveTheFlowOfOneRank) {
  auto together = make(MPI_COMM_WORLD, GetParam());
  auto alone = make(MPI_COMM_SELF, GetParam());
  for (const auto& [steps, limit] : {std::pair{1, 1e-12}, std::pair{100, 1e-8}}) {
    const int from = steps == 1 ? 0 : 1;
    advance(*together, from, steps);
    advance(*alone, from, steps);
    const auto parts = together->save(), whole = alone->save();
    for (const auto& [name, array] : parts) {
      const double difference = largest_difference(array, whole.at(name));
      EXPECT_LT(difference, limit) << name << " after " << steps << " steps";
      RecordProperty(name + "_after_" + std::to_string(steps), std::to_string(difference));
    }
    EXPECT_NEAR(together->flow_through(20), alone->flow_through(20), limit * 1e5);
    EXPECT_NEAR(together->mean_pressure(17), alone->mean_pressure(17), limit * 1e5);
    const Vec3 x(0.3, -0.2, 0.1);
    EXPECT_NEAR((together->velocity_at(x) - alone->velocity_at(x)).norm(), 0, limit * 1e3);
    EXPECT_NEAR(together->pressure_at(x), alone->pressure_at(x), limit * 1e5);
    if (GetParam().tube) {
      EXPECT_NEAR((together->solids().force_on(1) - alone->solids().force_on(1)).norm(), 0, limit * 1e6);
    }
    const state::Image parts_image = together->image(), whole_image = alone->image();
    if (mpi::rank(MPI_COMM_WORLD) == 0) {
      EXPECT_EQ(parts_image.point_data.at("velocity_mm_per_s").shape,
                whole_image.point_data.at("velocity_mm_per_s").shape);
    }
  }
}

TEST_P(Ranks, StateOfOneRankContinuesOnSeveral) {
  auto alone = make(MPI_COMM_SELF, GetParam());
  advance(*alone, 0, 10);
  state::State stored;
  stored.restart = alone->save();
  auto together = make(MPI_COMM_WORLD, GetParam());
  together->load(stored);
  advance(*alone, 10, 20);
  advance(*together, 10, 20);
  const auto parts = together->save(), whole = alone->save();
  for (const auto& [name, array] : parts) EXPECT_LT(largest_difference(array, whole.at(name)), 1e-10) << name;
}

TEST(ImplicitViscosity, GivesTheFlowOfOneRankWithinItsTolerance) {
  for (Side z : {Side::open, Side::periodic, Side::wall}) {
    const auto run = [&](MPI_Comm comm) {
      Grid grid;
      grid.cells = {12, 10, 24};
      grid.h = 0.5;
      grid.origin = Vec3(-3, -2.5, -6);
      Boundaries boundaries;
      boundaries.side[1] = {Side::wall, Side::wall};
      boundaries.side[2] = {z, z};
      FlowParameters parameters;
      parameters.implicit_viscosity = true;
      parameters.viscosity = 1;
      auto flow = std::make_unique<Flow>(comm, grid, boundaries, parameters);
      flow->solids().set_lumen([](const Vec3& x) { return std::abs(x[0]) - 2.2; });
      flow->set_velocity(rough);
      for (int step = 0; step < 20; ++step) flow->step(2e-4);
      return flow;
    };
    const auto parts = run(MPI_COMM_WORLD)->save(), whole = run(MPI_COMM_SELF)->save();
    for (const char* name : {"fluid/velocity_x", "fluid/velocity_z"}) {
      if (mpi::rank(MPI_COMM_WORLD) == 0) {
        EXPECT_LT(largest_difference(parts.at(name), whole.at(name)), 1e-8) << name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Ranks,
    testing::Values(Scene{"tube", Side::slip, Side::slip, Side::open, Side::open, true},
                    Scene{"inflow", Side::slip, Side::wall, Side::inflow, Side::open, true},
                    Scene{"box", Side::wall, Side::wall, Side::wall, Side::wall, false},
                    Scene{"periodic", Side::periodic, Side::periodic, Side::periodic, Side::periodic, false},
                    Scene{"thinning", Side::slip, Side::wall, Side::inflow, Side::open, true, 2, true},
                    Scene{"smooth", Side::slip, Side::slip, Side::open, Side::open, true, 2, false, true},
                    Scene{"order4", Side::periodic, Side::periodic, Side::periodic, Side::periodic, false, 4},
                    Scene{"pipe", Side::slip, Side::slip, Side::periodic, Side::periodic, true},
                    Scene{"upwind", Side::wall, Side::slip, Side::wall, Side::open, true, 2, false, true,
                          true},
                    Scene{"upwind_pipe", Side::slip, Side::wall, Side::periodic, Side::periodic, true, 2,
                          false, false, true}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
