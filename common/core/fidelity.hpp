// The fidelity ladder: draft, standard, fine, reference (see docs/architecture.md for what each level sets).
#pragma once

#include <string>

namespace valsalva {

enum class Fidelity { draft = 0, standard = 1, fine = 2, reference = 3 };

/// Throws InputError for an unknown name.
Fidelity fidelity_from(const std::string& name);
std::string name_of(Fidelity level);

}  // namespace valsalva
