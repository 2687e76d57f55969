// The solid of Turek and Hron's benchmark alone (CSM1) and in slow flow (FSI1).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "solve/statics.hpp"
#include "structure/dead_load.hpp"
#include "turek_hron.hpp"

namespace {

using namespace valsalva;

// A row of the table, by column; empty when the table is not there.
std::map<std::string, double> reference(const std::string& test) {
  std::ifstream in(std::string(VALSALVA_REFERENCE) + "/turek_hron.csv");
  std::vector<std::string> names;
  std::map<std::string, double> row;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
    } else if (cells[0] == test) {
      for (std::size_t i = 1; i < cells.size(); ++i)
        if (!cells[i].empty()) row[names[i]] = std::stod(cells[i]);
    }
  }
  return row;
}

TEST(TurekHron, BarUnderItsWeight) {
  const std::map<std::string, double> expected = reference("CSM1");
  if (expected.empty()) GTEST_SKIP() << "no reference in " << VALSALVA_REFERENCE;
  turek::Bar bar;
  bar.along = 35;
  bar.across = 2;
  turek::BuiltBar built = turek::build(bar);
  const double gravity = expected.at("g_m_s2") * 1e3;
  built.terms.push_back(std::make_shared<structure::DeadLoadTerm>(
      "gravity", structure::weight_of(*built.system, built.body, Vec3(-gravity, 0, 0)), Points{},
      [](double t) { return t; }));
  solve::Statics statics(*built.system, built.terms, {});
  const Vec3 before = built.system->state.x[built.tip];
  statics.advance_to(1);
  const Vec3 moved = built.system->state.x[built.tip] - before;
  EXPECT_NEAR(moved.z() / expected.at("ux_A_mm_mean"), 1, 0.01);
  EXPECT_NEAR(moved.x() / expected.at("uy_A_mm_mean"), 1, 0.01);
}

}  // namespace
