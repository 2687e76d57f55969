// What one run left behind, stage by stage. Anything may be absent or damaged; what is wrong is kept as a
// sentence.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "state/state.hpp"

namespace valsalva::report {

/// A table of numbers with named columns, read from CSV.
struct Series {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;  ///< NaN where a cell is empty or not a number
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
  const std::vector<double>* find(const std::string& name) const;
};

/// Cells of a CSV text, quotes honoured ("" inside quotes is one quote).
std::vector<std::vector<std::string>> parse_csv(const std::string& text);
Series series_of(const std::vector<std::vector<std::string>>& cells);

struct StageData {
  std::string name;
  bool present = false;  ///< its folder exists
  std::optional<nlohmann::json> summary;
  std::optional<Series> history;
  std::optional<state::State> state;  ///< the newest
  std::string contours_png;           ///< bytes of contours.png
  std::vector<std::string> problems;  ///< what could not be read, and why

  std::string status() const;  ///< of the summary; "not run", or "no summary"
  /// A number of the summary's metrics.
  std::optional<double> metric(const std::string& key) const;
};

struct RunData {
  std::string case_name;
  std::filesystem::path folder;   ///< runs/<case>
  std::vector<StageData> stages;  ///< in the order of the chain
  const StageData& stage(const std::string& name) const;
  bool empty() const;  ///< no stage has left anything
};

inline const std::vector<std::string> stage_names{"segment", "mesher", "stent", "crimp", "deploy", "cycle"};

RunData read_run(const std::filesystem::path& folder, const std::string& case_name);

/// EnvironmentError when it cannot be read.
std::string read_file(const std::filesystem::path& path);

}  // namespace valsalva::report
