// Published figures beside which the report puts the metrics of a run (data/published.toml).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace valsalva::report {

struct PublishedFigure {
  std::string metric, stage, shown, what, source, where;
  std::optional<double> low, high, value;  ///< a range, or a single figure
  std::vector<std::string> cases;          ///< beginnings of case names; empty: all

  bool concerns(const std::string& case_name) const;
  /// "inside", "above", "below" for a range; the difference in per cent for a single figure. No judgement.
  std::string compare(double found) const;
};

struct PublishedSource {
  std::string title, doi;
};

struct Published {
  std::vector<PublishedFigure> figures;
  std::map<std::string, PublishedSource> sources;
};

/// Parses the data file. InputError when an entry lacks what is needed; `label` names the text in messages.
Published parse_published(const std::string& toml, const std::string& label);

/// The data file that was built in.
const Published& published();

}  // namespace valsalva::report
