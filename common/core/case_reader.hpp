// Turns the text of a case file and the overrides into a validated Case.
#pragma once

#include <string>
#include <vector>

#include "core/case.hpp"

namespace valsalva {

class CaseReader {
 public:
  CaseReader(const Schema& schema, Fidelity fidelity, std::string label);
  Case read(const std::string& text, const std::vector<std::string>& overrides);

 private:
  struct Impl;
  const Schema& schema_;
  Fidelity fidelity_;
  std::string label_;
};

}  // namespace valsalva
