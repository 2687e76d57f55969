// Parameters are declared once: key, type, default, range, unit (the key's own ending) and doc.
// Validation with "did you mean", --help, --check and the generated reference page all come from here.
//
//   void declare_crimp(Schema& schema) {
//     schema.table("crimp", "Closing the device into its sheath");
//     schema.real("crimp.speed_mm_per_s", 500, {1, 5000}, "Radial speed of the crimper");
//     schema.real("crimp.element_mm", {1.0, 0.7, 0.5, 0.4}, {0.1, 3}, "Leaflet edge length");  // by fidelity
//   }
//
// A table of several entries ([[body]]) is declared with `tables` and read through Case::entries.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/fidelity.hpp"

namespace valsalva {

/// The value of one parameter. Paths are text.
using Value =
    std::variant<bool, std::int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;

/// A default that may depend on the fidelity level.
template <class T>
class ByFidelity {
 public:
  ByFidelity(T same) : values_{same, same, same, same} {}  // NOLINT: implicit on purpose
  ByFidelity(T draft, T standard, T fine, T reference) : values_{draft, standard, fine, reference} {}
  const T& at(Fidelity level) const { return values_[static_cast<int>(level)]; }

 private:
  std::array<T, 4> values_;
};

struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_excluded = false;  ///< (low, high] instead of [low, high]
};
inline Range positive() {
  return {0, std::numeric_limits<double>::infinity(), true};
}
inline Range not_negative() {
  return {0, std::numeric_limits<double>::infinity(), false};
}
inline Range unlimited() {
  return {};
}

struct Parameter {
  enum class Kind { boolean, integer, real, text, choice, reals, texts };
  std::string key;
  Kind kind;
  ByFidelity<Value> standard;        ///< the default
  Range range;                       ///< of numbers
  std::vector<std::string> choices;  ///< of Kind::choice
  std::size_t length = 0;            ///< of Kind::reals; 0: any
  std::string doc;
};

struct Table {
  std::string name;
  std::string doc;
  bool repeated = false;  ///< [[name]]
};

class Schema {
 public:
  Schema& table(std::string name, std::string doc);
  Schema& tables(std::string name, std::string doc);
  Schema& boolean(std::string key, bool standard, std::string doc);
  Schema& integer(std::string key, std::int64_t standard, Range range, std::string doc);
  Schema& real(std::string key, ByFidelity<double> standard, Range range, std::string doc);
  Schema& text(std::string key, std::string standard, std::string doc);
  Schema& choice(std::string key, std::string standard, std::vector<std::string> choices, std::string doc);
  /// length 0: any number of entries.
  Schema& reals(std::string key, std::vector<double> standard, std::size_t length, Range range,
                std::string doc);
  Schema& texts(std::string key, std::vector<std::string> standard, std::string doc);

  const Parameter* find(const std::string& key) const;
  const Table* find_table(const std::string& name) const;
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<Table>& tables() const { return tables_; }
  /// The known key nearest to a misspelt one; empty when nothing is near.
  std::string nearest_key(const std::string& key) const;
  std::string nearest_table(const std::string& name) const;
  /// The reference page (Markdown), and the same for one table in a terminal.
  std::string reference_page() const;
  std::string help_of(const std::string& table) const;

 private:
  Schema& add(Parameter parameter);
  std::vector<Table> tables_;
  std::vector<Parameter> parameters_;
  std::map<std::string, std::size_t> by_key_;
};

/// The candidate within a small edit distance of `word`; empty when none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace valsalva
