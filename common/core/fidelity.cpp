#include "core/fidelity.hpp"

#include <array>

#include "core/errors.hpp"
#include "core/schema.hpp"

namespace valsalva {
namespace {

const std::array<std::string, 4> names{"draft", "standard", "fine", "reference"};

}  // namespace

Fidelity fidelity_from(const std::string& name) {
  for (std::size_t level = 0; level < names.size(); ++level)
    if (names[level] == name) return static_cast<Fidelity>(level);
  const std::string near = nearest(name, {names.begin(), names.end()});
  throw InputError("--fidelity: found '{}', expected draft, standard, fine or reference{}", name,
                   near.empty() ? "" : "; did you mean '" + near + "'?");
}

std::string name_of(Fidelity level) {
  return names[static_cast<int>(level)];
}

}  // namespace valsalva
