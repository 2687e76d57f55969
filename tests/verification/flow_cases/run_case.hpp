// Runs a scene of fluid given as text to its end and reads its metrics and profiles.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "core/errors.hpp"
#include "flow_scene/scene.hpp"
#include "mpi_for_all.hpp"
#include "scene/scene.hpp"
#include "temporary_folder.hpp"

namespace valsalva::test {

inline Schema schema() {
  Schema all;
  declare_all(all);
  return all;
}

class FlowRun {
 public:
  explicit FlowRun(const std::string& text, const std::vector<std::string>& overrides = {},
                   MPI_Comm comm = MPI_COMM_SELF)
      : case_(Case::from_text(text, "case.toml", schema(), Fidelity::standard, overrides)),
        scene(case_, comm) {
    scene.add_row();
  }
  /// A file of the case library.
  static std::string library(const std::string& name) {
    std::ostringstream whole;
    whole << std::ifstream(std::string(LIBRARY_CASES) + "/" + name).rdbuf();
    return whole.str();
  }
  FlowRun& to_end() {
    while (!scene.finished()) step();
    return *this;
  }
  void step() {
    scene.step();
    if (scene.row_due()) scene.add_row();
  }
  double metric(const std::string& name) const {
    const auto all = scene.metrics();
    const auto at = all.find(name);
    if (at == all.end()) throw std::logic_error("no metric " + name);
    return at->second;
  }
  /// Columns of a profile: by name.
  std::map<std::string, std::vector<double>> profile(const std::string& name) {
    for (const auto& [file, text] : scene.profiles()) {
      if (file != "profile_" + name + ".csv") continue;
      std::istringstream in(text);
      std::string line, cell;
      std::vector<std::string> names;
      std::getline(in, line);
      for (std::istringstream header(line); std::getline(header, cell, ',');) names.push_back(cell);
      std::map<std::string, std::vector<double>> columns;
      while (std::getline(in, line)) {
        std::istringstream cells(line);
        for (const std::string& column : names) {
          std::getline(cells, cell, ',');
          columns[column].push_back(std::stod(cell));
        }
      }
      return columns;
    }
    throw std::logic_error("no profile " + name);
  }

 private:
  Case case_;

 public:
  flow_scene::FlowScene scene;
};

/// Rows of numbers of a reference file (fluid/NAME); empty when the reference data are not there.
inline std::vector<std::vector<double>> reference(const std::string& name) {
  const Case here = Case::load(std::string(CASES) + "/empty.toml", schema(), Fidelity::standard, {});
  std::ifstream file(here.resolve("shared:fluid/" + name));
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (double value; cells >> value;) row.push_back(value);
    if (row.size() > 1) rows.push_back(row);
  }
  return rows;
}

/// Published figures: value of a case and a quantity in fluid/flow_bluff_bodies.csv.
inline std::optional<double> figure(const std::string& of_case, const std::string& quantity) {
  const Case here = Case::load(std::string(CASES) + "/empty.toml", schema(), Fidelity::standard, {});
  std::ifstream in(here.resolve("shared:fluid/flow_bluff_bodies.csv"));
  for (std::string line; std::getline(in, line);) {
    const auto field = line.find("," + quantity + ",");
    if (line.starts_with(of_case) && field != std::string::npos)
      return std::stod(line.substr(field + quantity.size() + 2));
  }
  return std::nullopt;
}

inline double interpolated(const std::vector<double>& x, const std::vector<double>& y, double at) {
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (at > x[i] && i + 1 < x.size()) continue;
    return y[i - 1] + (at - x[i - 1]) / (x[i] - x[i - 1]) * (y[i] - y[i - 1]);
  }
  return y.back();
}

}  // namespace valsalva::test
