// The text of pipelines/materials/laws.toml, built in.
#pragma once

#include <string>

namespace valsalva::materials {

std::string built_in_laws();

}  // namespace valsalva::materials
