// The device as stent hands it on, made into a mechanical system: frame, leaflets, skirt, ties.
#pragma once

#include <memory>

#include "parameters.hpp"
#include "state/state.hpp"
#include "structure/shell_term.hpp"
#include "structure/tie.hpp"

namespace valsalva::crimp {

struct TissueBody {
  std::string name;
  std::shared_ptr<const structure::Shell> shell;
  Points mounted;          ///< where it lies on the uncrimped frame; ties and contact refer to this shape
  std::vector<Edge> ties;  ///< tissue node, frame node
};

struct Device {
  std::shared_ptr<const structure::BeamNetwork> frame;
  std::vector<TissueBody> tissue;  ///< leaflets, skirt; none for a bare frame
};

/// InputError names the file and the entry that is missing or does not fit.
Device read_device(const state::State& stent, const Parameters& p);

/// Bodies "frame", "leaflets", "skirt" in the mounted shape, at rest.
structure::System make_system(const Device& device, const Parameters& p);

/// Frame (a BeamTerm), shells and ties.
std::vector<std::shared_ptr<structure::ForceTerm>> elastic_terms(const Device& device, const Parameters& p,
                                                                 const structure::System& system);

}  // namespace valsalva::crimp
