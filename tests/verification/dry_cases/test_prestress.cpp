// Shapes that are seen loaded.
#include "assembly/prestress.hpp"
#include "run_case.hpp"
#include "tables.hpp"

using namespace valsalva;

namespace {

// A quarter of a tube between planes of symmetry, seen under 6 kPa.
std::string tube(const std::string& course, const std::string& dynamics) {
  return R"(
[[body]]
name = "tube"
kind = "solid"
shape = "cylinder"
radius_mm = 10
wall_mm = 2
angle_deg = [0, 90]
size_mm = [4]
divisions = [8, 2, 2]
element = "hex8"
)" + test::tissue +
         test::held("tube", "start1", "[\"y\"]") + test::held("tube", "end1", "[\"x\"]") +
         test::held("tube", "start2", "[\"z\"]") + test::held("tube", "end2", "[\"z\"]") +
         test::group("tube", "start3") + R"(
[[load]]
name = "blood"
kind = "pressure"
body = "tube"
nodes = "start3"
pressure_kPa = 6
)" + course +
         "[dynamics]\nload_steps = 4\nprestress = \"backward_displacement\"\nprestress_tolerance_mm = "
         "1e-4\n" +
         dynamics;
}

struct Loaded {
  explicit Loaded(const std::string& text)
      : input(Case::from_text(text, "tube", test::schema(), Fidelity::standard)),
        found(assembly::find_stress_free(input,
                                         [this](int k, double error) {
                                           if (k == 1) first = error;
                                         })),
        scene(assembly::compose(input, found.reference)),
        march(assembly::make_march(input, scene)) {
    if (!found.equilibrium.empty()) march->start_from(found.equilibrium, found.stored_nJ);
  }
  void to_end() {
    while (!march->finished()) march->step();
  }
  double from_stress_free() const {
    const Points &now = scene.system->state.x, &free = found.reference.at("tube");
    double most = 0;
    for (std::size_t a = 0; a < free.size(); ++a) most = std::max(most, (now[a] - free[a]).norm());
    return most;
  }
  Case input;
  double first = 0;  // by how far the given shape, loaded once more, misses itself
  assembly::Prestress found;
  assembly::Scene scene;
  std::unique_ptr<assembly::March> march;
};

}  // namespace

// Loaded again it is the tube that was seen.
TEST(DryPrestress, StaticsLoadsItToTheGivenShape) {
  Loaded run(tube("", "solver = \"static\"\n"));
  run.to_end();
  std::printf("prestress: %.3f mm at first, %.2e mm after %d equilibria\n", run.first, run.found.error_mm,
              run.found.iterations);
  EXPECT_GT(run.first, 0.1);
  EXPECT_LE(assembly::distance_from_given(run.scene), 1e-4);
  // It is smaller than what was seen.
  EXPECT_LT(run.found.reference.at("tube")[0].norm(), 9.9);
}

// Under the pressure of the start it stays in the given shape, which a tube without prestress would leave.
TEST(DryPrestress, DynamicsStartsAtRestInTheGivenShape) {
  for (const char* solver : {"implicit", "explicit"}) {
    Loaded run(tube("", "end_s = 2e-3\nstep_s = 1e-4\nsolver = \"" + std::string(solver) + "\"\n"));
    EXPECT_GT(run.first, 0.1) << solver;
    EXPECT_LE(assembly::distance_from_given(run.scene), 1e-4) << solver;
    const double stored = run.march->stored_nJ();
    EXPECT_GT(stored, 0) << solver;
    run.to_end();
    EXPECT_LE(assembly::distance_from_given(run.scene), 1.01e-4) << solver;
    EXPECT_LT(run.march->kinetic_nJ(), 1e-8 * stored) << solver;
    EXPECT_NEAR(run.march->stored_nJ(), stored, 1e-6 * stored) << solver;
  }
}

// The pressure goes to zero, and damping lets it come to rest: stress free.
TEST(DryPrestress, DynamicsUnloadsItToTheStressFreeShape) {
  Loaded run(tube("time_s = [0, 2e-3]\nfactor = [1, 0]\n",
                  "end_s = 0.03\nstep_s = 5e-4\ndamping_per_s = 3000\nsolver = \"implicit\"\n"));
  const double start = run.from_stress_free();
  EXPECT_GT(start, 0.1);
  run.to_end();
  std::printf("let go: %.3f mm from the stress-free shape at first, %.2e mm in the end\n", start,
              run.from_stress_free());
  EXPECT_LT(run.from_stress_free(), 1e-3 * start);
}
