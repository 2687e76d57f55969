#include "state/parents.hpp"

#include <algorithm>

#include <fmt/ranges.h>

#include "core/errors.hpp"
#include "state/state.hpp"

namespace valsalva::state {

namespace fs = std::filesystem;

std::vector<fs::path> parent_states(StageContext& context, const std::vector<std::string>& stages) {
  std::string given;
  if (context.from) {
    given = read(*context.from, "").stage;
    if (std::find(stages.begin(), stages.end(), given) == stages.end())
      throw InputError("{}: it is a state of stage '{}', expected one of stage '{}'", context.from->string(),
                       given, fmt::join(stages, "' or '"));
  }
  std::vector<fs::path> states;
  for (const std::string& stage : stages) {
    const bool beside_given = context.from && stage != given;
    states.push_back(
        beside_given ? context.newest_state(fs::absolute(*context.from).parent_path().parent_path(), stage)
                     : context.parent_state(stage));
  }
  return states;
}

}  // namespace valsalva::state
