// The folder of one stage's run, runs/<case>/<stage>/: states, views, history.csv, summary.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace valsalva {

/// Writes text to a temporary name in the same folder, fsyncs and renames. EnvironmentError on failure.
void write_atomically(const std::filesystem::path& path, const std::string& text);

/// A pass-or-fail check of a stage's own result.
struct Check {
  double value = 0;
  double limit = 0;
  bool pass = false;
};

/// summary.json of a stage; docs/architecture.md lists the metric names.
struct Summary {
  std::string stage, case_name, status = "ok", fidelity;
  int ranks = 1;
  long steps = 0;
  double simulated_s = 0;
  double wall_s = 0;
  std::map<std::string, std::string> inputs;  ///< path -> sha256
  std::string parameters_sha256;
  std::map<std::string, double> metrics;
  std::map<std::string, Check> checks;
  std::map<std::string, std::string> notes;  ///< what the reader must know: assumptions, model choices
  nlohmann::json extra;                      ///< further data for the report (curves, accuracy band, message)
  nlohmann::json to_json() const;
};

/// history.csv: the unit is in each column's name. Rewritten whole and atomically, so that a resumed run
/// continues exactly where its state stands.
class History {
 public:
  explicit History(std::vector<std::string> columns);
  void add(const std::vector<double>& row);
  const std::vector<std::string>& columns() const { return columns_; }
  std::size_t rows() const { return columns_.empty() ? 0 : values_.size() / columns_.size(); }
  double at(std::size_t row, const std::string& column) const;
  std::vector<double> column(const std::string& name) const;
  /// Row-major, for storing in a state file and back.
  const std::vector<double>& values() const { return values_; }
  void restore(std::vector<double> values);
  void write(const std::filesystem::path& path) const;

 private:
  std::size_t index_of(const std::string& column) const;
  std::vector<std::string> columns_;
  std::vector<double> values_;
};

class RunFolder {
 public:
  /// Creates the folder. EnvironmentError when it cannot be created or written.
  explicit RunFolder(std::filesystem::path path);
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path file(const std::string& name) const { return path_ / name; }
  std::filesystem::path state_path(long index) const;
  /// All state_NNNNNN.h5 by ascending index.
  std::vector<std::filesystem::path> states() const;
  std::optional<std::filesystem::path> latest_state() const;
  static long index_of(const std::filesystem::path& state);
  /// A run that starts afresh looks past the states of an earlier one: states() leaves them out, and prune()
  /// removes them, that is, not before the new run has written a state of its own.
  void disregard_present_states();
  /// Removes all states but the last two. Call it after each state written.
  void prune() const;
  void write_summary(const Summary& summary) const;

 private:
  bool is_disregarded(const std::filesystem::path& state) const;
  std::filesystem::path path_;
  std::map<std::filesystem::path, std::uint64_t> disregarded_;  ///< path -> inode
};

}  // namespace valsalva
