// A case file: which bodies, fluid, contact and boundaries exist, and the values that differ from the
// defaults.
//
// Unknown or misspelt keys, wrong types, non-finite and out-of-range values are InputErrors that name the
// file, the line, the key, what was found, what is expected, and a suggestion.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/schema.hpp"

namespace valsalva {

class Case {
 public:
  /// overrides: "table.key=value" as given to --set; "table.NAME.key=value" for the entry NAME of a repeated
  /// table.
  static Case load(const std::filesystem::path& file, const Schema& schema, Fidelity fidelity,
                   const std::vector<std::string>& overrides);
  static Case from_text(const std::string& text, const std::string& label, const Schema& schema,
                        Fidelity fidelity, const std::vector<std::string>& overrides = {});

  bool boolean(const std::string& key) const;
  std::int64_t integer(const std::string& key) const;
  double real(const std::string& key) const;
  const std::string& text(const std::string& key) const;
  const std::vector<double>& reals(const std::string& key) const;
  const std::vector<std::string>& texts(const std::string& key) const;
  /// Was the key written in the file or given by --set?
  bool is_set(const std::string& key) const { return set_.count(key) > 0; }
  /// Does the scene have this table? What is absent is not built.
  bool has(const std::string& table) const { return present_.count(table) > 0; }
  /// The entries of a repeated table, [[name]]; keys of an entry are written "name.key".
  const std::vector<Case>& entries(const std::string& table) const;

  const std::string& name() const { return name_; }
  const std::filesystem::path& file() const { return file_; }
  Fidelity fidelity() const { return fidelity_; }
  /// A path in the case file: relative ones start at the case file's folder; "shared:" at the reference data.
  std::filesystem::path resolve(const std::string& path) const;

  /// The effective parameters, one "key = value" a line, sorted; the same text is digested and stored.
  std::string effective() const;
  /// Only the given tables: what a stage depends on.
  std::string effective(const std::set<std::string>& tables) const;

 private:
  friend class CaseReader;
  const Value& value(const std::string& key) const;
  std::string name_;
  std::filesystem::path file_;
  Fidelity fidelity_ = Fidelity::standard;
  std::map<std::string, Value> values_;
  std::set<std::string> set_;
  std::set<std::string> present_;
  std::map<std::string, std::vector<Case>> entries_;
};

}  // namespace valsalva
