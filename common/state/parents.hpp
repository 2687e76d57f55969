// The states a stage with several parents starts from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/stage.hpp"

namespace valsalva::state {

/// One state for each of `stages`, in their order. --from is the one whose stage it is, and the others are
/// the newest of their folders beside its own (runs/<case>/crimp/state.h5 -> runs/<case>/mesher/); without
/// --from all of them lie beside this stage's folder. InputError: --from is of none of these stages, or a
/// state is missing.
std::vector<std::filesystem::path> parent_states(StageContext& context,
                                                 const std::vector<std::string>& stages);

}  // namespace valsalva::state
