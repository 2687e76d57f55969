// A [[contact_pair]] entry: two bodies, a body and itself, or a body and a rigid surface.
#pragma once

#include "assembly/entry.hpp"
#include "assembly/scene.hpp"

namespace valsalva::assembly {

/// InputError names the entry.
void add_contact(Scene& scene, const Case& file, const Entry& e);

}  // namespace valsalva::assembly
