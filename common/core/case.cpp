#include "core/case.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "core/case_reader.hpp"
#include "core/errors.hpp"
#include "core/value_text.hpp"

namespace valsalva {

Case Case::load(const std::filesystem::path& file, const Schema& schema, Fidelity fidelity,
                const std::vector<std::string>& overrides) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw InputError(
        "{}: cannot be read; give the path of a case file (TOML), see pipelines/cases for samples",
        file.string());
  std::ostringstream text;
  text << stream.rdbuf();
  Case result = CaseReader(schema, fidelity, file.string()).read(text.str(), overrides);
  result.file_ = std::filesystem::absolute(file);
  if (!result.is_set("case.name")) result.name_ = file.stem().string();
  return result;
}

Case Case::from_text(const std::string& text, const std::string& label, const Schema& schema,
                     Fidelity fidelity, const std::vector<std::string>& overrides) {
  return CaseReader(schema, fidelity, label).read(text, overrides);
}

const Value& Case::value(const std::string& key) const {
  const auto found = values_.find(key);
  if (found == values_.end())
    throw std::logic_error("internal error: parameter '" + key + "' was read but never declared");
  return found->second;
}

bool Case::boolean(const std::string& key) const {
  return std::get<bool>(value(key));
}
std::int64_t Case::integer(const std::string& key) const {
  return std::get<std::int64_t>(value(key));
}
double Case::real(const std::string& key) const {
  return std::get<double>(value(key));
}
const std::string& Case::text(const std::string& key) const {
  return std::get<std::string>(value(key));
}
const std::vector<double>& Case::reals(const std::string& key) const {
  return std::get<std::vector<double>>(value(key));
}
const std::vector<std::string>& Case::texts(const std::string& key) const {
  return std::get<std::vector<std::string>>(value(key));
}

const std::vector<Case>& Case::entries(const std::string& table) const {
  static const std::vector<Case> none;
  const auto found = entries_.find(table);
  return found == entries_.end() ? none : found->second;
}

std::filesystem::path Case::resolve(const std::string& path) const {
  constexpr std::string_view shared = "shared:";
  if (path.starts_with(shared)) {
    // VALSALVA_SHARED names the folder of the reference data; by default it lies beside the checkout.
    const char* given = std::getenv("VALSALVA_SHARED");
    std::filesystem::path root = given ? given : "";
    if (!given) {
      for (auto folder = file_.parent_path(); folder.has_relative_path(); folder = folder.parent_path())
        if (std::filesystem::is_directory(folder / "shared" / "reference")) {
          root = folder / "shared" / "reference";
          break;
        }
      if (root.empty()) root = file_.parent_path() / "../../../shared/reference";
    }
    return (root / path.substr(shared.size())).lexically_normal();
  }
  const std::filesystem::path plain(path);
  return plain.is_absolute() ? plain : (file_.parent_path() / plain).lexically_normal();
}

std::string Case::effective() const {
  std::string lines;
  for (const auto& [key, value] : values_) lines += fmt::format("{} = {}\n", key, text_of(value));
  for (const auto& [table, list] : entries_)
    for (std::size_t i = 0; i < list.size(); ++i)
      for (const auto& [key, value] : list[i].values_)
        lines += fmt::format("{}[{}].{} = {}\n", table, i, key.substr(table.size() + 1), text_of(value));
  return lines;
}

std::string Case::effective(const std::set<std::string>& tables) const {
  std::istringstream all(effective());
  std::string kept;
  for (std::string line; std::getline(all, line);)
    if (tables.count(line.substr(0, line.find_first_of(".[")))) kept += line + '\n';
  return kept;
}

}  // namespace valsalva
