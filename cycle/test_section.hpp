// A valve held in a vessel that formulas give ([test_section]), as in a pulse duplicator: what cycle
// otherwise takes from its parent's state comes from the case file. Bodies, sets of nodes and supports are
// those of docs/scenes.md: the one shell (of hinges) is the leaflets and moves with the blood, its supported
// nodes stay where they are; rigid bodies are solid to the blood and hold it. The vessel:
//
//   r(theta, z) = R(z) + depth sin^2(pi (z - z1)/(z2 - z1)) (1 + cos 3 (theta - theta_0))/2
//
// R linear between the given heights; the second term, three sinuses, between z1 and z2 only. Its level set
// is (r - r(theta, z)) / sqrt(1 + (dr/dz)^2): a distance to first order, exact in sign.
//
// Limits: leaflets bend as hinges do; their law is hgo, neo-hookean, holzapfel with equal families or
// lee-sacks with w = 1; no thickness of the rigid bodies but cycle.shell_mask_cells.
#pragma once

#include "inputs.hpp"

namespace valsalva::cycle {

bool has_test_section(const Case& scene);

/// Law and bending of the shell: its material, membrane_scale and bending_scale.
Tissue tissue_in_test_section(const Case& scene);

/// InputError names the case file, the entry and the key.
Inputs test_section_inputs(const Case& scene, const Parameters& p);

}  // namespace valsalva::cycle
