#include "materials/library.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/schema.hpp"
#include "materials/built_in_laws.hpp"

namespace valsalva::materials {
namespace {

constexpr double radians = M_PI / 180;

// One material's table: every key is taken once, and what is left over is unknown.
class Reader {
 public:
  Reader(const toml::table& table, std::string where) : table_(table), where_(std::move(where)) {}

  std::string text(const char* key, const std::string& standard) {
    const toml::node* node = take(key);
    if (!node) return standard;
    if (const auto value = node->value<std::string>()) return *value;
    fail(key, "a text");
  }
  std::string required_text(const char* key) {
    if (!table_.contains(key)) throw InputError("{}: '{}' is missing; expected a text", where_, key);
    return text(key, "");
  }
  double number(const std::string& key) {
    const toml::node* node = take(key);
    const auto value = node->value<double>();
    if (!value || std::isnan(*value)) fail(key, "a number");
    return *value;
  }
  bool truth(const char* key, bool standard) {
    const toml::node* node = take(key);
    if (!node) return standard;
    if (const auto value = node->value_exact<bool>()) return *value;
    fail(key, "true or false");
  }
  std::vector<double> numbers(const char* key, std::size_t most) {
    std::vector<double> values;
    const toml::node* node = take(key);
    if (!node) return values;
    const toml::array* list = node->as_array();
    if (!list || list->size() > most) fail(key, "a list of one number a fibre family, two at most");
    for (const toml::node& entry : *list) {
      const auto value = entry.value<double>();
      if (!value || !std::isfinite(*value)) fail(key, "a list of numbers");
      values.push_back(*value);
    }
    return values;
  }
  bool has(const char* key) const { return table_.contains(key); }
  /// Whatever no one has asked for yet.
  std::vector<std::string> left() const {
    std::vector<std::string> keys;
    for (const auto& [key, node] : table_)
      if (std::find(taken_.begin(), taken_.end(), key.str()) == taken_.end()) keys.emplace_back(key.str());
    return keys;
  }
  const std::string& where() const { return where_; }

 private:
  const toml::node* take(const std::string& key) {
    taken_.push_back(key);
    return table_.get(key);
  }
  [[noreturn]] void fail(const std::string& key, const char* expected) const {
    throw InputError("{}: '{}' must be {}", where_, key, expected);
  }
  const toml::table& table_;
  std::string where_;
  std::vector<std::string> taken_;
};

MaterialSet read_set(const std::string& name, Reader& in) {
  MaterialSet set;
  set.name = name;
  set.law = in.required_text("law");
  set.used_for = in.required_text("used_for");
  set.source = in.required_text("source");
  set.assumed = in.text("assumed", "");
  set.volumetric.form = volumetric_form(in.text("volumetric", "none"));
  if (in.has("bulk_modulus_Pa")) set.volumetric.modulus_Pa = in.number("bulk_modulus_Pa");
  const std::string split = in.text("split", "modified");
  if (split != "modified" && split != "full")
    throw InputError("{}: split = '{}'; expected modified or full", in.where(), split);
  set.split = split == "full" ? Split::full : Split::modified;
  set.incompressible_sheet = in.truth("incompressible_sheet", true);
  set.fibre_angles_deg = in.numbers("fibre_angles_deg", 2);
  for (const std::string& key : in.left()) set.parameters[key] = in.number(key);
  return set;
}

}  // namespace

std::shared_ptr<const PlaneLaw> MaterialSet::plane_law() const {
  if (incompressible_sheet) return elastic_law();
  return std::make_shared<SolidLaw>(solid_law());
}

PlaneFibres MaterialSet::plane_fibres() const {
  PlaneFibres fibres;
  fibres.count = static_cast<int>(fibre_angles_deg.size());
  for (int i = 0; i < fibres.count; ++i) {
    const double angle = fibre_angles_deg[i] * radians;
    fibres.direction[i] = {std::cos(angle), std::sin(angle)};
  }
  return fibres;
}

MaterialLibrary::MaterialLibrary(const std::string& text, const std::string& label) : label_(label) {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InputError("{}:{}: {}", label, error.source().begin.line, error.description());
  }
  for (const auto& [key, node] : root) {
    const std::string name(key.str());
    const toml::table* table = node.as_table();
    if (!table)
      throw InputError("{}: '{}' must be a table: write [\"paper/material\"] above it", label, name);
    Reader reader(*table, label + ": " + name);
    sets_.push_back(read_set(name, reader));
    try {
      sets_.back().solid_law();
    } catch (const InputError& error) {
      throw InputError("{}: {}: {}", label, name, error.what());
    }
  }
}

const MaterialLibrary& MaterialLibrary::built_in() {
  static const MaterialLibrary library(built_in_laws(), "pipelines/materials/laws.toml");
  return library;
}

const MaterialSet& MaterialLibrary::find(const std::string& name) const {
  std::vector<std::string> known;
  for (const MaterialSet& set : sets_) {
    if (set.name == name) return set;
    known.push_back(set.name);
  }
  const std::string near = nearest(name, known);
  throw InputError("material '{}' is not in {}{}; valsalva-material --sets lists all", name, label_,
                   near.empty() ? "" : "; did you mean '" + near + "'?");
}

}  // namespace valsalva::materials
