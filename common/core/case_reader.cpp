#include "core/case_reader.hpp"

#include <fmt/ranges.h>

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/value_text.hpp"

namespace valsalva {
namespace {

std::string suggestion(const std::string& near) {
  return near.empty() ? "" : "; did you mean '" + near + "'?";
}

std::string found_text(const toml::node& node) {
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

}  // namespace

/// One reading: the Case under construction, and where messages point to.
struct CaseReader::Impl {
  const Schema& schema;
  Fidelity fidelity;
  std::string label;
  Case result;

  [[noreturn]] void fail(const toml::node* node, const std::string& message) const {
    const auto line = node ? node->source().begin.line : 0;
    throw InputError("{}{}: {}", label, line ? fmt::format(":{}", line) : "", message);
  }

  void fill_defaults() {
    for (const Parameter& parameter : schema.parameters())
      if (!schema.find_table(parameter.key.substr(0, parameter.key.find('.')))->repeated)
        result.values_[parameter.key] = parameter.standard.at(fidelity);
  }

  void read_document(const toml::table& document) {
    for (const auto& [key, node] : document) {
      const std::string name(key.str());
      const Table* table = schema.find_table(name);
      if (!table)
        fail(&node, fmt::format("unknown table or key '{}'{}", name, suggestion(schema.nearest_table(name))));
      if (table->repeated) {
        read_entries(name, node);
      } else {
        const toml::table* content = node.as_table();
        if (!content) fail(&node, fmt::format("'{}' must be a table: write [{}]", name, name));
        result.present_.insert(name);
        read_table(name, *content, result);
      }
    }
  }

  void read_entries(const std::string& name, const toml::node& node) {
    const toml::array* array = node.as_array();
    if (!array || !array->is_homogeneous(toml::node_type::table))
      fail(&node, fmt::format("'{}' must be a repeated table: write [[{}]]", name, name));
    result.present_.insert(name);
    for (const toml::node& element : *array) {
      Case entry;
      entry.fidelity_ = fidelity;
      entry.name_ = result.name_;
      for (const Parameter& parameter : schema.parameters())
        if (parameter.key.starts_with(name + "."))
          entry.values_[parameter.key] = parameter.standard.at(fidelity);
      read_table(name, *element.as_table(), entry);
      result.entries_[name].push_back(std::move(entry));
    }
  }

  void read_table(const std::string& table, const toml::table& content, Case& into) {
    for (const auto& [key, node] : content) {
      const std::string full = table + "." + std::string(key.str());
      const Parameter* parameter = schema.find(full);
      if (!parameter)
        fail(&node, fmt::format("unknown key '{}'{}", full, suggestion(schema.nearest_key(full))));
      into.values_[full] = converted(*parameter, node);
      into.set_.insert(full);
    }
  }

  [[noreturn]] void mismatch(const Parameter& parameter, const toml::node& node,
                             const std::string& expected) const {
    fail(&node, fmt::format("{}: found {}, expected {} ({})", parameter.key, found_text(node), expected,
                            parameter.doc));
  }

  double number(const Parameter& parameter, const toml::node& whole, const toml::node& node) const {
    const auto value = node.value<double>();
    if (!value || node.is_boolean()) mismatch(parameter, whole, "a number" + text_of(parameter.range));
    if (!contains(parameter.range, *value))
      mismatch(parameter, whole,
               (std::isfinite(*value) ? "a number" : "a finite number") + text_of(parameter.range));
    return *value;
  }

  Value converted(const Parameter& parameter, const toml::node& node) const {
    using Kind = Parameter::Kind;
    switch (parameter.kind) {
      case Kind::boolean:
        if (!node.is_boolean()) mismatch(parameter, node, "true or false");
        return *node.value<bool>();
      case Kind::integer:
        if (!node.is_integer()) mismatch(parameter, node, "an integer" + text_of(parameter.range));
        number(parameter, node, node);
        return *node.value<std::int64_t>();
      case Kind::real:
        return number(parameter, node, node);
      case Kind::text:
        if (!node.is_string()) mismatch(parameter, node, "text in quotes");
        return *node.value<std::string>();
      case Kind::choice: {
        const auto word = node.value<std::string>();
        if (!node.is_string() || !std::count(parameter.choices.begin(), parameter.choices.end(), *word))
          mismatch(parameter, node,
                   fmt::format("one of {}{}", fmt::join(parameter.choices, ", "),
                               node.is_string() ? suggestion(nearest(*word, parameter.choices)) : ""));
        return *word;
      }
      case Kind::reals: {
        const toml::array* array = node.as_array();
        if (!array) mismatch(parameter, node, "a list of numbers");
        std::vector<double> values;
        for (const toml::node& element : *array) values.push_back(number(parameter, node, element));
        if (parameter.length && values.size() != parameter.length)
          mismatch(parameter, node, fmt::format("{} numbers", parameter.length));
        return values;
      }
      case Kind::texts: {
        const toml::array* array = node.as_array();
        if (!array) mismatch(parameter, node, "a list of texts");
        std::vector<std::string> values;
        for (const toml::node& element : *array) {
          if (!element.is_string()) mismatch(parameter, node, "a list of texts");
          values.push_back(*element.value<std::string>());
        }
        return values;
      }
    }
    throw std::logic_error("internal error: parameter kind");
  }

  /// What an override writes to: the case, or of a repeated table the entry "table.name.key" speaks of.
  Case& overridden(const std::string& key) {
    const auto first = key.find('.'), last = key.rfind('.');
    const std::string name = key.substr(0, first);
    const Table* table = schema.find_table(name);
    if (!table || !table->repeated) {
      if (table && first != last)
        throw InputError("{}: '{}' has one dot too many; expected table.key=value", label, key);
      return result;
    }
    std::vector<std::string> names;
    for (const Case& entry : result.entries(name)) names.push_back(entry.text(name + ".name"));
    if (first == last)
      throw InputError("{}: [[{}]] is repeated; expected {}.NAME.{}=value with NAME one of {}", label, name,
                       name, key.substr(last + 1), fmt::join(names, ", "));
    const std::string wanted = key.substr(first + 1, last - first - 1);
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found == names.end())
      throw InputError("{}: there is no [[{}]] named '{}'{}; expected one of {}", label, name, wanted,
                       suggestion(nearest(wanted, names)), fmt::join(names, ", "));
    return result.entries_[name][found - names.begin()];
  }

  void apply_override(const std::string& text) {
    label = "--set " + text;
    const auto equals = text.find('=');
    const std::string key = text.substr(0, equals);
    if (equals == std::string::npos || key.find('.') == std::string::npos)
      throw InputError("{}: expected table.key=value", label);
    Case& entry = overridden(key);
    const std::string full = key.substr(0, key.find('.')) + key.substr(key.rfind('.'));
    const Parameter* parameter = schema.find(full);
    if (!parameter)
      throw InputError("{}: unknown key '{}'{}", label, full, suggestion(schema.nearest_key(full)));
    std::string value = text.substr(equals + 1);
    // Words need no quotes on a command line.
    const bool wordy = parameter->kind == Parameter::Kind::text || parameter->kind == Parameter::Kind::choice;
    if (wordy && !value.starts_with('"')) value = text_of(Value(value));
    toml::table parsed;
    try {
      parsed = toml::parse("value = " + value);
    } catch (const toml::parse_error& error) {
      throw InputError("{}: '{}' is not a TOML value: {}", label, value, std::string(error.description()));
    }
    entry.values_[full] = converted(*parameter, *parsed.get("value"));
    entry.set_.insert(full);
    result.present_.insert(key.substr(0, key.find('.')));
  }
};

CaseReader::CaseReader(const Schema& schema, Fidelity fidelity, std::string label)
    : schema_(schema), fidelity_(fidelity), label_(std::move(label)) {}

Case CaseReader::read(const std::string& text, const std::vector<std::string>& overrides) {
  Impl impl{schema_, fidelity_, label_, {}};
  impl.result.fidelity_ = fidelity_;
  impl.fill_defaults();
  try {
    impl.read_document(toml::parse(text, label_));
  } catch (const toml::parse_error& error) {
    throw InputError("{}:{}: not valid TOML: {}", label_, error.source().begin.line,
                     std::string(error.description()));
  }
  for (const std::string& override_text : overrides) impl.apply_override(override_text);
  if (schema_.find("case.name")) impl.result.name_ = impl.result.text("case.name");
  return impl.result;
}

}  // namespace valsalva
