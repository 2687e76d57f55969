// Where the crimped device goes: turned about its axis, the skirt's edge at the commanded depth.
//
// The frame shortens while it expands. The depth is commanded for the final skirt edge, so the delivery
// system holds that height while the frame opens (loads.hpp), and its outflow comes down. Where a straight
// path would touch the wall, the axis is tilted about the annulus's centre towards the lumen's centre at the
// device's upper end, by as little as clears it.
#pragma once

#include <Eigen/Geometry>

#include "inputs.hpp"

namespace valsalva::deploy {

struct Placement {
  Eigen::Isometry3d to_world = Eigen::Isometry3d::Identity();
  double tilt_deg = 0;
  double radius_mm = 0;            ///< of the crimped device, outside
  double low_mm = 0, high_mm = 0;  ///< its ends along its own axis, in world heights
};

/// The frame nodes of the inflow row.
std::vector<int> inflow_nodes(const FrameBody& frame);
/// The lower edge of the skirt, or the inflow nodes' heights where there is none: (body index, node).
std::vector<int> skirt_edge_nodes(const ShellBody& skirt);
const ShellBody* find(const std::vector<ShellBody>& bodies, const std::string& name);

/// InputError when the device does not fit into the lumen.
Placement place(const Inputs& in, const Parameters& p);

/// Moves and turns positions, velocities and rotations of the device.
void apply(const Placement& placement, Inputs& in);

}  // namespace valsalva::deploy
