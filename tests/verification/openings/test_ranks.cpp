// The flow through oblique openings on one and on several ranks, started by mpirun.
#include "mpi_for_all.hpp"
#include "tube.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

void advance(Flow& flow, int from, int to) {
  for (int step = from; step < to; ++step) {
    flow.openings().set_pressure(0, 300 * std::sin(0.15 * step));
    flow.openings().set_pressure(1, 7);
    flow.after_projection([&](double dt, const StepReport&) {
      return flow.raise({{1, 40 * std::cos(0.2 * step)}}, dt);
    });
    flow.step(1e-4 * (1 + 0.3 * std::sin(step)));
  }
}

double largest_difference(const state::Array& a, const state::Array& b) {
  const auto &p = a.doubles("a"), &q = b.doubles("b");
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    difference = std::max(difference, std::abs(p[i] - q[i]));
    largest = std::max(largest, std::abs(q[i]));
  }
  return largest > 0 ? difference / largest : difference;
}

}  // namespace

TEST(Ranks, GiveTheFlowOfOneRank) {
  for (const Wall wall : {Wall::staircase, Wall::interpolated}) {
    test::Tube tube;
    tube.wall = wall;
    tube.tolerance = 1e-13;
    auto together = tube.flow(MPI_COMM_WORLD), alone = tube.flow(MPI_COMM_SELF),
         again = tube.flow(MPI_COMM_WORLD);
    advance(*together, 0, 60);
    advance(*alone, 0, 60);
    EXPECT_GT(std::abs(alone->opening_flow(1)), 100);
    EXPECT_NEAR(together->opening_flow(1), alone->opening_flow(1), 1e-8 * std::abs(alone->opening_flow(1)));
    EXPECT_EQ(together->pressure_unknowns(), alone->pressure_unknowns());
    const auto parts = together->save(), whole = alone->save();
    for (const std::string name : {"velocity_x", "velocity_y", "velocity_z", "pressure"}) {
      if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
      EXPECT_LT(largest_difference(parts.at("fluid/" + name), whole.at("fluid/" + name)), 1e-8) << name;
    }
    // Equal ranks, equal bits; and the same from a state of one rank in between.
    advance(*again, 0, 60);
    const auto second = again->save();
    for (const auto& [name, array] : parts)
      EXPECT_EQ(array.doubles(name), second.at(name).doubles(name)) << name;
    auto first = tube.flow(MPI_COMM_SELF), resumed = tube.flow(MPI_COMM_SELF);
    advance(*first, 0, 25);
    state::State stored;
    stored.restart = first->save();
    resumed->load(stored);
    advance(*resumed, 25, 60);
    for (const auto& [name, array] : resumed->save())
      EXPECT_EQ(array.doubles(name), whole.at(name).doubles(name)) << name;
  }
}
