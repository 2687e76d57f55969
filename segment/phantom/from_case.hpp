// The phantom of a case's [phantom] table.
#pragma once

#include "core/case.hpp"
#include "phantom.hpp"

namespace valsalva::segment {

Phantom phantom_of(const Case& scene);

}  // namespace valsalva::segment
