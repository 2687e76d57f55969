#include "run_data.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/errors.hpp"
#include "core/run_folder.hpp"

namespace valsalva::report {
namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw EnvironmentError("{}: cannot be read; check that it exists and its permissions", path.string());
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

const std::vector<double>* Series::find(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? nullptr : &columns[static_cast<std::size_t>(found - names.begin())];
}

std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  std::string cell;
  bool quoted = false;
  const auto end_row = [&] {
    row.push_back(std::exchange(cell, {}));
    if (row.size() > 1 || !row.front().empty()) rows.push_back(row);
    row.clear();
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"') {
      cell += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      row.push_back(std::exchange(cell, {}));
    } else if (c == '\n' && !quoted) {
      end_row();
    } else if (c != '\r') {
      cell += c;
    }
  }
  if (!cell.empty() || !row.empty()) end_row();
  return rows;
}

Series series_of(const std::vector<std::vector<std::string>>& cells) {
  Series series;
  if (cells.empty()) return series;
  series.names = cells.front();
  series.columns.resize(series.names.size());
  for (std::size_t r = 1; r < cells.size(); ++r)
    for (std::size_t c = 0; c < series.names.size(); ++c) {
      double value = std::numeric_limits<double>::quiet_NaN();
      if (c < cells[r].size() && !cells[r][c].empty()) {
        char* end = nullptr;
        const double number = std::strtod(cells[r][c].c_str(), &end);
        if (*end == '\0' && std::isfinite(number)) value = number;
      }
      series.columns[c].push_back(value);
    }
  return series;
}

std::string StageData::status() const {
  if (!present) return "not run";
  if (!summary || !summary->is_object()) return "no summary";
  return summary->value("status", "unknown");
}

std::optional<double> StageData::metric(const std::string& key) const {
  if (!summary) return std::nullopt;
  const auto metrics = summary->find("metrics");
  if (metrics == summary->end() || !metrics->is_object()) return std::nullopt;
  const auto found = metrics->find(key);
  if (found == metrics->end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

const StageData& RunData::stage(const std::string& name) const {
  const auto found =
      std::find_if(stages.begin(), stages.end(), [&](const StageData& s) { return s.name == name; });
  VALSALVA_ASSERT(found != stages.end());
  return *found;
}

bool RunData::empty() const {
  return std::none_of(stages.begin(), stages.end(),
                      [](const StageData& s) { return s.summary || s.history || s.state; });
}

namespace {

/// Runs one reader; its failure becomes a sentence of the stage.
template <class Reader>
void attempt(StageData& stage, const fs::path& file, Reader&& reader) {
  if (!fs::exists(file)) return;
  try {
    reader();
  } catch (const std::exception& error) {
    const std::string what = error.what();
    stage.problems.push_back(what.find(file.filename().string()) == std::string::npos
                                 ? file.filename().string() + ": " + what
                                 : what);
  }
}

StageData read_stage(const fs::path& folder, const std::string& name) {
  StageData stage;
  stage.name = name;
  const fs::path own = folder / name;
  stage.present = fs::is_directory(own);
  if (!stage.present) return stage;
  attempt(stage, own / "summary.json", [&] {
    nlohmann::json summary = nlohmann::json::parse(read_file(own / "summary.json"));
    if (!summary.is_object()) throw InputError("not a JSON object");
    stage.summary = std::move(summary);
  });
  attempt(stage, own / "history.csv", [&] {
    Series series = series_of(parse_csv(read_file(own / "history.csv")));
    if (series.rows() > 0) stage.history = std::move(series);
  });
  attempt(stage, own / "contours.png", [&] { stage.contours_png = read_file(own / "contours.png"); });
  if (const auto latest = RunFolder(own).latest_state())
    attempt(stage, *latest, [&] { stage.state = state::read(*latest, name); });
  return stage;
}

}  // namespace

RunData read_run(const fs::path& folder, const std::string& case_name) {
  RunData run;
  run.case_name = case_name;
  run.folder = folder;
  for (const std::string& name : stage_names) run.stages.push_back(read_stage(folder, name));
  return run;
}

}  // namespace valsalva::report
