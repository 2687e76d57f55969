// What cycle takes from its parent's state (deploy, or mesher where the scene has no device): the lumen, the
// leaflets that move, the bodies that are held; and the box of the fluid around them.
#pragma once

#include <optional>

#include "fluid/flow.hpp"
#include "geometry/grid_sdf.hpp"
#include "parameters.hpp"
#include "state/state.hpp"

namespace valsalva::cycle {

struct Leaflets {
  std::string name;  ///< "leaflets" or "native_leaflets"
  Points points;     ///< at the start
  Points rest;       ///< where neighbours do not repel: as mounted on the frame, or as at the start
  structure::ShellMesh mesh;
  std::vector<std::uint8_t> attached;
  std::vector<int> leaflet;      ///< of each node
  std::vector<Edge> attachment;  ///< the attached edge
  std::array<int, 3> tip{};      ///< the node of each leaflet's free edge furthest from its attachment
  double mean_edge_mm = 0;
};

struct HeldFrame {
  Points points;
  std::vector<Edge> struts;
  std::vector<double> half_depth_mm;
};

struct HeldShell {
  Points points;
  std::vector<Triangle> triangles;
};

struct Inputs {
  state::State parent;
  geometry::GridSdf lumen;
  double low_z_mm = 0, high_z_mm = 0;  ///< the two cuts
  std::optional<Leaflets> leaflets;    ///< nothing: a scene without a valve
  std::optional<HeldFrame> frame;
  std::optional<HeldShell> skirt, native;
  std::optional<HeldShell> mount;   ///< of a valve in a test section
  double friction_capacity_uN = 0;  ///< of the anchored device

  /// Signed distance to the wall, with the cuts taken as open.
  double wall_distance(const Vec3& x) const;
};

Inputs read_inputs(const std::filesystem::path& parent, const Parameters& p);

/// From points, mesh and attached: the leaflet of each node, the attached edge, tips, mean edge. leaflet: of
/// each triangle. InputError with `source`.
void complete(Leaflets& l, const std::vector<std::int64_t>& leaflet, const std::string& source);

/// The box that hugs lumen and leaflets between the cuts: at least two cells of margin across (the kernels
/// need them), ends at the cuts.
fluid::Grid box_of(const Inputs& in, double h, double margin_cells);

/// Marks wall, held bodies and the ring at the attached edge. The numbers of the bodies that are the device:
/// what the blood pushes through them goes into the anchors.
std::vector<int> mark_solids(const Inputs& in, const Masks& masks, fluid::Solids& solids, double h);

}  // namespace valsalva::cycle
