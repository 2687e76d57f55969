#include "core/run_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/errors.hpp"
#include "core/provenance.hpp"

namespace valsalva {
namespace fs = std::filesystem;

namespace {

/// Tells a file from another that has since taken its name.
std::uint64_t inode_of(const fs::path& path) {
  struct stat found {};
  return ::stat(path.c_str(), &found) == 0 ? found.st_ino : 0;
}

}  // namespace

void write_atomically(const fs::path& path, const std::string& text) {
  const fs::path part = path.string() + ".part";
  const auto fail = [&](const char* what) {
    const int reason = errno;
    ::unlink(part.c_str());
    throw EnvironmentError(
        "{}: {} failed: {}; free space or change permissions, then run again with --resume", path.string(),
        what, std::strerror(reason));
  };
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file < 0) fail("open");
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(file, text.data() + done, text.size() - done);
    if (written < 0) {
      ::close(file);
      fail("write");
    }
    done += static_cast<std::size_t>(written);
  }
  const bool synced = ::fsync(file) == 0;
  if ((::close(file) != 0) || !synced) fail("fsync");
  if (::rename(part.c_str(), path.c_str()) != 0) fail("rename");
}

nlohmann::json Summary::to_json() const {
  // JSON has no NaN: a metric that could not be computed is null, so that nobody reads a number into it.
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  };
  nlohmann::json out;
  out["schema"] = "valsalva-summary-1";
  out["stage"] = stage;
  out["case"] = case_name;
  out["status"] = status;
  out["version"] = version();
  out["fidelity"] = fidelity;
  out["ranks"] = ranks;
  out["steps"] = steps;
  out["simulated_s"] = number(simulated_s);
  out["wall_s"] = number(wall_s);
  out["peak_rss_MiB"] = number(peak_rss_MiB());
  out["inputs"] = inputs;
  out["parameters_sha256"] = parameters_sha256;
  out["metrics"] = nlohmann::json::object();
  for (const auto& [name, value] : metrics) out["metrics"][name] = number(value);
  out["checks"] = nlohmann::json::object();
  for (const auto& [name, check] : checks)
    out["checks"][name] = {
        {"value", number(check.value)}, {"limit", number(check.limit)}, {"pass", check.pass}};
  out["notes"] = notes;
  if (!extra.is_null()) out["extra"] = extra;
  return out;
}

History::History(std::vector<std::string> columns) : columns_(std::move(columns)) {}

void History::add(const std::vector<double>& row) {
  VALSALVA_ASSERT(row.size() == columns_.size());
  values_.insert(values_.end(), row.begin(), row.end());
}

std::size_t History::index_of(const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  VALSALVA_ASSERT(found != columns_.end());
  return static_cast<std::size_t>(found - columns_.begin());
}

double History::at(std::size_t row, const std::string& column) const {
  return values_.at(row * columns_.size() + index_of(column));
}

std::vector<double> History::column(const std::string& name) const {
  std::vector<double> result;
  for (std::size_t i = index_of(name); i < values_.size(); i += columns_.size()) result.push_back(values_[i]);
  return result;
}

void History::restore(std::vector<double> values) {
  VALSALVA_ASSERT(values.size() % columns_.size() == 0);
  values_ = std::move(values);
}

void History::write(const fs::path& path) const {
  std::string text;
  for (std::size_t c = 0; c < columns_.size(); ++c) text += (c ? "," : "") + columns_[c];
  text += '\n';
  for (std::size_t i = 0; i < values_.size(); ++i)
    text += fmt::format("{:.9g}{}", values_[i], (i + 1) % columns_.size() ? ',' : '\n');
  write_atomically(path, text);
}

RunFolder::RunFolder(fs::path path) : path_(std::move(path)) {
  std::error_code failed;
  fs::create_directories(path_, failed);
  if (failed || ::access(path_.c_str(), W_OK) != 0)
    throw EnvironmentError("{}: cannot be created or written: {}; give another folder with --out",
                           path_.string(), failed ? failed.message() : std::strerror(errno));
}

fs::path RunFolder::state_path(long index) const {
  return path_ / fmt::format("state_{:06d}.h5", index);
}

std::vector<fs::path> RunFolder::states() const {
  std::vector<fs::path> found;
  if (!fs::is_directory(path_)) return found;
  for (const auto& entry : fs::directory_iterator(path_))
    if (index_of(entry.path()) >= 0 && !is_disregarded(entry.path())) found.push_back(entry.path());
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return index_of(a) < index_of(b); });
  return found;
}

std::optional<fs::path> RunFolder::latest_state() const {
  const auto found = states();
  return found.empty() ? std::nullopt : std::optional(found.back());
}

long RunFolder::index_of(const fs::path& state) {
  const std::string name = state.filename().string();
  const std::string digits = name.size() > 9 ? name.substr(6, name.size() - 9) : "";
  const bool matches =
      name.starts_with("state_") && name.ends_with(".h5") && !digits.empty() &&
      std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); });
  return matches ? std::stol(digits) : -1;
}

void RunFolder::disregard_present_states() {
  for (const fs::path& state : states()) disregarded_[state] = inode_of(state);
}

bool RunFolder::is_disregarded(const fs::path& state) const {
  const auto found = disregarded_.find(state);
  return found != disregarded_.end() && found->second == inode_of(state);
}

void RunFolder::prune() const {
  const auto found = states();
  if (found.empty()) return;
  for (const auto& [path, inode] : disregarded_)
    if (fs::exists(path) && is_disregarded(path)) fs::remove(path);
  for (std::size_t i = 0; i + 2 < found.size(); ++i) fs::remove(found[i]);
}

void RunFolder::write_summary(const Summary& summary) const {
  write_atomically(file("summary.json"), summary.to_json().dump(2) + "\n");
}

}  // namespace valsalva
