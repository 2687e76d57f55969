// What the parents hand over: the crimped device and the anatomy with its native leaflets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/grid_sdf.hpp"
#include "parameters.hpp"
#include "state/state.hpp"
#include "structure/shell.hpp"

namespace valsalva::deploy {

struct ShellBody {
  std::string name;
  Points points, velocity;
  Points mounted;  ///< on the uncrimped frame; native leaflets: as fitted
  std::vector<bool> attached;
  std::shared_ptr<structure::Shell> shell;
  double density = 0;
};

struct FrameBody {
  std::shared_ptr<structure::BeamNetwork> network;
  Points points, velocity, angular_velocity;
  std::vector<Eigen::Quaterniond> rotation;
  structure::FibreHistory fibres;  ///< of superelastic struts
};

struct Inputs {
  state::State crimp, mesher;
  FrameBody frame;
  std::vector<ShellBody> tissue;        ///< leaflets and skirt, those that there are
  std::vector<std::vector<Edge>> ties;  ///< of tissue[i]: tissue node, frame node
  std::optional<ShellBody> native;
  geometry::GridSdf wall;  ///< negative inside the lumen
};

/// InputError names the file, the entry, and what is expected there.
Inputs read_inputs(const std::filesystem::path& crimp, const std::filesystem::path& mesher,
                   const Parameters& p);

}  // namespace valsalva::deploy
