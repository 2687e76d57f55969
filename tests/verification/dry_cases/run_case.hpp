// Runs a case file of this folder to its end, or up to a time, and reads its probes; reads reference tables.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "assembly/march.hpp"
#include "assembly/probes.hpp"
#include "scene/scene.hpp"
#include "temporary_folder.hpp"

namespace valsalva::test {

inline Schema schema() {
  Schema all;
  declare_all(all);
  return all;
}

class CaseRun {
 public:
  /// replacements: texts of the file and what to put in their place.
  explicit CaseRun(const std::string& file,
                   const std::vector<std::pair<std::string, std::string>>& replacements = {})
      : CaseRun(load(file, replacements)) {}

  /// A scene given here, with files beside it.
  static std::unique_ptr<CaseRun> of_text(const std::string& text,
                                          const std::map<std::string, std::string>& files = {}) {
    const TemporaryFolder folder;
    for (const auto& [name, content] : files) std::ofstream(folder / name) << content;
    std::ofstream(folder / "case.toml") << text;
    return std::unique_ptr<CaseRun>(
        new CaseRun(Case::load(folder / "case.toml", schema(), Fidelity::standard, {})));
  }

  void to_end() {
    while (!march->finished()) march->step();
  }
  void until(double time_s) {
    while (!march->finished() && scene.system->state.time_s < time_s - 1e-9 * time_s) march->step();
  }
  double probe(const std::string& column) const {
    const auto& names = probes_.columns();
    const auto at = std::find(names.begin(), names.end(), column);
    if (at == names.end()) throw std::logic_error("no probe " + column);
    return probes_.values(scene, march->kinetic_nJ())[at - names.begin()];
  }

 private:
  static Case load(const std::string& file,
                   const std::vector<std::pair<std::string, std::string>>& replacements) {
    std::ostringstream whole;
    whole << std::ifstream(std::filesystem::path(CASES) / file).rdbuf();
    std::string text = whole.str();
    for (const auto& [from, to] : replacements) {
      if (text.find(from) == std::string::npos) throw std::logic_error(file + " does not hold: " + from);
      for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    }
    return Case::from_text(text, file, schema(), Fidelity::standard);
  }
  explicit CaseRun(Case loaded)
      : case_(std::move(loaded)),
        scene(assembly::compose(case_)),
        march(assembly::make_march(case_, scene)),
        probes_(case_, scene) {}
  Case case_;

 public:
  assembly::Scene scene;
  std::unique_ptr<assembly::March> march;

 private:
  assembly::Probes probes_;
};

/// Rows of a reference table, comments and header left out; empty when the reference data are not there.
inline std::vector<std::vector<std::string>> reference(const std::string& name) {
  const Case here =
      Case::load(std::filesystem::path(CASES) / "cantilever_beam.toml", schema(), Fidelity::standard, {});
  std::ifstream file(here.resolve("shared:shells_beams_solids/" + name));
  std::vector<std::vector<std::string>> rows;
  bool header = true;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (header) {
      header = false;
      continue;
    }
    rows.emplace_back();
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

}  // namespace valsalva::test
