#include "published.hpp"

#include <toml++/toml.h>

#include <cmath>

#include "assets.hpp"
#include "core/errors.hpp"
#include "html.hpp"

namespace valsalva::report {

bool PublishedFigure::concerns(const std::string& case_name) const {
  if (cases.empty()) return true;
  for (const std::string& beginning : cases)
    if (case_name.starts_with(beginning)) return true;
  return false;
}

std::string PublishedFigure::compare(double found) const {
  if (value) {
    const double percent = 100 * (found - *value) / std::abs(*value);
    return (percent < 0 ? "−" : "+") + number(std::abs(percent), 2) + " %";
  }
  if (found < *low) return "below";
  return found > *high ? "above" : "inside";
}

Published parse_published(const std::string& toml, const std::string& label) {
  toml::table root;
  try {
    root = toml::parse(toml, label);
  } catch (const toml::parse_error& error) {
    throw InputError("{}: line {}: {}", label, error.source().begin.line, error.description());
  }
  Published result;
  if (const toml::table* sources = root["sources"].as_table())
    for (const auto& [key, entry] : *sources) {
      const toml::node_view<const toml::node> source(entry);
      result.sources[std::string(key.str())] = {source["title"].value_or(std::string()),
                                                source["doi"].value_or(std::string())};
    }
  if (const toml::array* figures = root["figure"].as_array())
    for (const toml::node& node : *figures) {
      const toml::node_view<const toml::node> entry(node);
      PublishedFigure figure;
      figure.metric = entry["metric"].value_or(std::string());
      figure.stage = entry["stage"].value_or(std::string());
      figure.shown = entry["shown"].value_or(std::string());
      figure.what = entry["what"].value_or(std::string());
      figure.source = entry["source"].value_or(std::string());
      figure.where = entry["where"].value_or(std::string());
      figure.low = entry["low"].value<double>();
      figure.high = entry["high"].value<double>();
      figure.value = entry["value"].value<double>();
      if (const toml::array* cases = entry["cases"].as_array())
        for (const toml::node& name : *cases) figure.cases.push_back(name.value_or(std::string()));
      const bool range = figure.low && figure.high;
      if (figure.metric.empty() || figure.stage.empty() || range == figure.value.has_value())
        throw InputError("{}: line {}: an entry needs metric, stage and either low and high or value", label,
                         node.source().begin.line);
      if (!result.sources.count(figure.source))
        throw InputError("{}: line {}: source '{}' is not among [sources]", label, node.source().begin.line,
                         figure.source);
      result.figures.push_back(std::move(figure));
    }
  return result;
}

const Published& published() {
  static const Published data = parse_published(assets::published_toml(), "published.toml");
  return data;
}

}  // namespace valsalva::report
