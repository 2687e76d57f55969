// All elastic laws by name, with their parameters: key (with unit), meaning, and the band in which a fit
// searches. `valsalva-material --laws` prints it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "materials/elastic_law.hpp"

namespace valsalva::materials {

struct LawParameter {
  std::string key;
  std::string doc;
  double low, high;                ///< where a fit searches; the law itself may allow more
  std::optional<double> standard;  ///< used when the parameter is not given
  bool required = !standard;       ///< must be given
};

using ParameterValues = std::map<std::string, double>;

struct LawEntry {
  std::string name;
  std::string equation;
  int fibre_families;  ///< the most it can use
  std::vector<LawParameter> parameters;
  std::shared_ptr<const ElasticLaw> (*make)(const ParameterValues&);
};

const std::vector<LawEntry>& law_catalogue();

/// InputError with "did you mean" on an unknown law.
const LawEntry& find_law(const std::string& name);

/// InputError on an unknown law or key ("did you mean"), a missing parameter, or a value that the law
/// refuses.
std::shared_ptr<const ElasticLaw> make_law(const std::string& name, const ParameterValues& given);

}  // namespace valsalva::materials
