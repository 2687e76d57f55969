// The table of measured beats: read, interpolated, carried on beyond its grids, refused; and what --estimate
// says of it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "../../../cycle/measured.hpp"
#include "core/errors.hpp"
#include "temporary_folder.hpp"

namespace valsalva::cycle {
namespace {

// Made up: steps like h^-1, seconds a step like h^-2, error of the gradient like h^2, of the volume first
// order.
const std::string made_up =
    "# command: made up\n"
    "valve,spacing_mm,ranks,steps,simulated_s,processor_s,memory_MiB,mean_gradient_mmHg_error_pct,"
    "stroke_volume_mL_error_pct,error_basis\n"
    "healthy,2,1,1000,0.5,10,100,16,2,\"grids 0.5, 2 mm\"\n"
    "healthy,0.5,1,4000,0.5,640,400,1,0.5,\"grids 0.5, 2 mm\"\n"
    "device,1,2,2000,0.5,40,200,,,\n";

TEST(MeasuredBeats, BetweenGridsEverythingIsAPowerOfTheSpacing) {
  const Expectation e = expect(read_measured(made_up), "healthy", 1, 0.25, 1);
  EXPECT_NEAR(e.wall_s, 1000 * 0.04, 1e-9);  // half of the time: 1000 steps of 0.04 s
  EXPECT_NEAR(e.memory_MiB, 200, 1e-9);
  EXPECT_NEAR(e.error_pct.at("mean_gradient_mmHg"), 4, 1e-9);
  EXPECT_NEAR(e.error_pct.at("stroke_volume_mL"), 1, 1e-9);
  EXPECT_NE(e.basis.find("healthy valve at h = 0.5, 2 mm"), std::string::npos) << e.basis;
  EXPECT_EQ(e.basis.find("carried on"), std::string::npos) << e.basis;
}

TEST(MeasuredBeats, AtAMeasuredGridItsRowAnswers) {
  const Expectation e = expect(read_measured(made_up), "healthy", 2, 0.5, 1);
  EXPECT_NEAR(e.wall_s, 10, 1e-9);
  EXPECT_NEAR(e.error_pct.at("mean_gradient_mmHg"), 16, 1e-9);
}

TEST(MeasuredBeats, BeyondTheGridsTheErrorFallsAtFirstOrderAndTheBasisSaysSo) {
  const auto table = read_measured(made_up);
  const Expectation fine = expect(table, "healthy", 0.25, 0.5, 1);
  EXPECT_NEAR(fine.error_pct.at("mean_gradient_mmHg"), 0.5, 1e-9);
  EXPECT_NEAR(fine.wall_s, 640 * std::pow(2.0, 1.4) * 8, 1e-6);
  EXPECT_NE(fine.basis.find("carried on from 0.5 mm"), std::string::npos) << fine.basis;
  EXPECT_NE(expect(table, "healthy", 3, 0.5, 1).basis.find("carried on from 2 mm"), std::string::npos);
}

TEST(MeasuredBeats, RanksShareTheTime) {
  const auto table = read_measured(made_up);
  // 40 s of processor on two ranks: 20 s of the clock.
  EXPECT_NEAR(expect(table, "device", 1, 0.5, 2).wall_s, 20, 1e-9);
  EXPECT_NEAR(expect(table, "device", 1, 0.5, 1).wall_s, 20 * std::pow(2, 0.77), 1e-9);
  EXPECT_TRUE(expect(table, "device", 1, 0.5, 2).error_pct.empty());
  EXPECT_NE(in_words(expect(table, "device", 1, 0.5, 2)).find("error unknown"), std::string::npos);
}

TEST(MeasuredBeats, AValveThatWasNotMeasuredSaysWhoseBeatIsTaken) {
  const Expectation e = expect(read_measured(made_up), "stenotic", 1, 0.5, 1);
  EXPECT_NE(e.basis.find("not this kind of valve"), std::string::npos) << e.basis;
  EXPECT_THROW(expect({}, "healthy", 1, 1, 1), InputError);
}

TEST(MeasuredBeats, RefusesATableThatIsNoTable) {
  const std::string head = "valve,spacing_mm,ranks,steps,simulated_s,processor_s,memory_MiB,error_basis\n";
  EXPECT_NO_THROW(read_measured(head + "device,1,2,2000,0.5,40,200,\n"));
  EXPECT_THROW(read_measured(head + "device,1,2,2000,0.5,40\n"), InputError);
  EXPECT_THROW(read_measured(head + "device,1,2,many,0.5,40,200,\n"), InputError);
  EXPECT_THROW(read_measured(head + "device,0,2,2000,0.5,40,200,\n"), InputError);
  EXPECT_THROW(read_measured(head + "device,1,2,2000,0.5,nan,200,\n"), InputError);
}

/// Seconds that --estimate predicts, -1 where it fails; text: all it says.
double estimated(const std::string& options, std::string& text) {
  test::TemporaryFolder folder;
  std::ofstream(folder / "case.toml") << "[native]\n[fluid]\n[circulation]\n";
  const std::string command =
      std::string(CYCLE_PROGRAM) + " " + (folder / "case.toml").string() + " --estimate " + options;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), buffer.size(), pipe)) text += buffer.data();
  double seconds = -1;
  if (pclose(pipe) != 0 || std::sscanf(text.c_str(), "predicted wall time: %lf", &seconds) != 1) return -1;
  return seconds;
}

TEST(MeasuredBeats, TheProgramEstimatesFromItsTable) {
  std::string draft, fine, text;
  const double at_draft = estimated("--fidelity draft", draft), at_fine = estimated("--fidelity fine", fine);
  EXPECT_GT(at_draft, 10) << draft;
  EXPECT_GT(at_fine, 5 * at_draft) << fine;
  for (const std::string& said : {draft, fine}) EXPECT_NE(said.find("measured: "), std::string::npos) << said;
  EXPECT_NEAR(estimated("--fidelity draft --set cycle.duration_s=0.4406", text) / at_draft, 0.5, 0.02);
}

}  // namespace
}  // namespace valsalva::cycle
