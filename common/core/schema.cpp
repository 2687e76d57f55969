#include "core/schema.hpp"

#include <algorithm>
#include <numeric>

#include "core/errors.hpp"
#include "core/value_text.hpp"

namespace valsalva {
namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

std::string table_of(const std::string& key) {
  return key.substr(0, key.find('.'));
}

std::string kind_text(const Parameter& parameter) {
  using Kind = Parameter::Kind;
  switch (parameter.kind) {
    case Kind::boolean:
      return "true or false";
    case Kind::integer:
      return "integer" + text_of(parameter.range);
    case Kind::real:
      return "number" + text_of(parameter.range);
    case Kind::text:
      return "text";
    case Kind::choice:
      return "one of " + fmt::format("{}", fmt::join(parameter.choices, ", "));
    case Kind::reals:
      return (parameter.length ? fmt::format("{} numbers", parameter.length)
                               : std::string("list of numbers")) +
             text_of(parameter.range);
    case Kind::texts:
      return "list of texts";
  }
  return {};
}

std::string default_text(const Parameter& parameter) {
  const std::string draft = text_of(parameter.standard.at(Fidelity::draft));
  bool same = true;
  std::vector<std::string> all;
  for (int level = 0; level < 4; ++level) {
    all.push_back(text_of(parameter.standard.at(static_cast<Fidelity>(level))));
    same = same && all.back() == draft;
  }
  return same ? draft : fmt::format("{} (draft, standard, fine, reference)", fmt::join(all, ", "));
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

Schema& Schema::table(std::string name, std::string doc) {
  tables_.push_back({std::move(name), std::move(doc), false});
  return *this;
}

Schema& Schema::tables(std::string name, std::string doc) {
  tables_.push_back({std::move(name), std::move(doc), true});
  return *this;
}

Schema& Schema::add(Parameter parameter) {
  VALSALVA_ASSERT(find_table(table_of(parameter.key)) != nullptr);
  VALSALVA_ASSERT(by_key_.count(parameter.key) == 0);
  by_key_[parameter.key] = parameters_.size();
  parameters_.push_back(std::move(parameter));
  return *this;
}

Schema& Schema::boolean(std::string key, bool standard, std::string doc) {
  return add({std::move(key), Parameter::Kind::boolean, Value(standard), {}, {}, 0, std::move(doc)});
}

Schema& Schema::integer(std::string key, std::int64_t standard, Range range, std::string doc) {
  return add({std::move(key), Parameter::Kind::integer, Value(standard), range, {}, 0, std::move(doc)});
}

Schema& Schema::real(std::string key, ByFidelity<double> standard, Range range, std::string doc) {
  const ByFidelity<Value> values(standard.at(Fidelity::draft), standard.at(Fidelity::standard),
                                 standard.at(Fidelity::fine), standard.at(Fidelity::reference));
  return add({std::move(key), Parameter::Kind::real, values, range, {}, 0, std::move(doc)});
}

Schema& Schema::text(std::string key, std::string standard, std::string doc) {
  return add({std::move(key), Parameter::Kind::text, Value(std::move(standard)), {}, {}, 0, std::move(doc)});
}

Schema& Schema::choice(std::string key, std::string standard, std::vector<std::string> choices,
                       std::string doc) {
  VALSALVA_ASSERT(std::count(choices.begin(), choices.end(), standard) == 1);
  return add({std::move(key),
              Parameter::Kind::choice,
              Value(std::move(standard)),
              {},
              std::move(choices),
              0,
              std::move(doc)});
}

Schema& Schema::reals(std::string key, std::vector<double> standard, std::size_t length, Range range,
                      std::string doc) {
  return add({std::move(key),
              Parameter::Kind::reals,
              Value(std::move(standard)),
              range,
              {},
              length,
              std::move(doc)});
}

Schema& Schema::texts(std::string key, std::vector<std::string> standard, std::string doc) {
  return add({std::move(key), Parameter::Kind::texts, Value(std::move(standard)), {}, {}, 0, std::move(doc)});
}

const Parameter* Schema::find(const std::string& key) const {
  const auto found = by_key_.find(key);
  return found == by_key_.end() ? nullptr : &parameters_[found->second];
}

const Table* Schema::find_table(const std::string& name) const {
  const auto found =
      std::find_if(tables_.begin(), tables_.end(), [&](const Table& t) { return t.name == name; });
  return found == tables_.end() ? nullptr : &*found;
}

std::string Schema::nearest_key(const std::string& key) const {
  // A key of the same table first, then any table's key of the same last name.
  std::vector<std::string> same_table, all;
  for (const Parameter& parameter : parameters_) {
    all.push_back(parameter.key);
    if (table_of(parameter.key) == table_of(key)) same_table.push_back(parameter.key);
  }
  const std::string near = nearest(key, same_table);
  if (!near.empty()) return near;
  const std::string last = key.substr(key.find('.') + 1);
  for (const std::string& candidate : all)
    if (candidate.substr(candidate.find('.') + 1) == last) return candidate;
  return nearest(key, all);
}

std::string Schema::nearest_table(const std::string& name) const {
  std::vector<std::string> names;
  for (const Table& table : tables_) names.push_back(table.name);
  return nearest(name, names);
}

std::string Schema::reference_page() const {
  std::string page =
      "# Case-file reference\n\nGenerated from the declarations by `build/bin/valsalva-cycle --reference`. "
      "Every "
      "key has a default; a case states only what differs. Dimensional keys end in their unit.\n";
  for (const Table& table : tables_) {
    page += fmt::format("\n## {}\n\n{}\n\n| key | expected | default | meaning |\n|---|---|---|---|\n",
                        table.repeated ? "[[" + table.name + "]]" : "[" + table.name + "]", table.doc);
    for (const Parameter& parameter : parameters_)
      if (table_of(parameter.key) == table.name)
        page += fmt::format("| `{}` | {} | {} | {} |\n", parameter.key.substr(table.name.size() + 1),
                            kind_text(parameter), default_text(parameter), parameter.doc);
  }
  return page;
}

std::string Schema::help_of(const std::string& name) const {
  const Table* table = find_table(name);
  if (!table) return {};
  std::string help = fmt::format("[{}]  {}\n", table->name, table->doc);
  for (const Parameter& parameter : parameters_)
    if (table_of(parameter.key) == name)
      help += fmt::format("  {} = {}\n      {}; {}\n", parameter.key, default_text(parameter), parameter.doc,
                          kind_text(parameter));
  return help;
}

}  // namespace valsalva
