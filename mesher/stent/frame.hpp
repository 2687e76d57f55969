// The frame of a self-expanding device as a beam network: struts between crossings, each strut cut into
// beams.
//
// Parametric frame: rows of diamond cells on a surface of revolution. Crossing k of row i stands at height
// level_mm[i] and angle (2 k + i mod 2) pi / cells; it is joined to the two nearest crossings of row i + 1.
// A strut is straight in the unrolled plane (angle, height), hence smoothly curved in space. The diameters of
// the profile are outer ones, as a caliper reads them: nodes stand on the radius d/2 - depth/2.
//
//   height H = level_mm.back()          outer diameter at a row: d(level_mm[i])
//   nodes    rows cells + struts (beams_per_strut - 1)      struts 2 cells (rows - 1)
//
// Node order: crossings row by row, then the inner nodes of the struts. Device axes: z is the axis, +z
// downstream, the inflow at z = 0. Lengths mm.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/types.hpp"
#include "profile.hpp"

namespace valsalva::stent {

struct FrameDesign {
  int cells = 0;                                  ///< diamonds around
  std::vector<double> level_mm;                   ///< heights of the rows of crossings, from 0
  std::vector<std::array<double, 2>> profile_mm;  ///< height, outer diameter
  double width_mm = 0;                            ///< of a strut, circumferential
  double depth_mm = 0;                            ///< radial
  int beams_per_strut = 4;
};

struct Strut {
  int from = 0, to = 0;  ///< crossings
  double width_mm = 0, depth_mm = 0;
};

struct Frame {
  Points nodes;
  std::vector<Edge> beams;
  std::vector<double> width_mm, depth_mm;  ///< per beam
  std::vector<Strut> struts;
  std::vector<std::vector<int>> strut_nodes;  ///< per strut, from its first crossing to its second
  int crossings = 0;                          ///< nodes [0, crossings) are crossings
  Profile profile;                            ///< of the nodes: where beams' centrelines lie
  double max_depth_mm = 0;                    ///< the largest section depth; tissue keeps clear of it
};

/// InputError names the entry that is wrong: too few cells or rows, heights not ascending, a section that
/// does not fit its cell.
Frame build_frame(const FrameDesign& design);

/// The smallest outer diameter at which all struts of the densest row stand side by side.
double closed_diameter_mm(int cells, double width_mm, double depth_mm);

/// From crossings and struts (a graph file); the profile is fitted through the crossings' radii, struts are
/// straight in the unrolled plane. InputError names the node or strut: fewer than two nodes, not finite, an
/// end that does not exist, zero length, the same strut twice, a node without struts, parts that are not
/// connected, a section that is not positive or thicker than the strut is long.
Frame frame_from_struts(const Points& crossings, const std::vector<Strut>& struts, int beams_per_strut,
                        const std::string& label);

struct FrameMeasures {
  double inflow_diameter_mm = 0;   ///< outer, over the lowest crossings
  double waist_diameter_mm = 0;    ///< outer, the smallest over all nodes
  double outflow_diameter_mm = 0;  ///< outer, over the highest crossings
  double height_mm = 0;
};
FrameMeasures measure(const Frame& frame);

/// How many beams meet at each node.
std::vector<int> degrees(const Frame& frame);

}  // namespace valsalva::stent
