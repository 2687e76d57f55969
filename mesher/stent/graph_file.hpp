// A frame as a centreline graph: a JSON file of crossings and struts.
//
//   { "format": "valsalva-frame-graph", "version": 1,
//     "section_mm": [0.25, 0.45],                     // width (circumferential), depth (radial): the default
//     "nodes_mm": [[12.8, 0, 0], [12.1, 2.6, 6.2], ...],
//     "struts": [[0, 1], [1, 7, 0.30, 0.45], ...] }    // node, node [, own width, own depth]
//
// The axis of the device is z, downstream positive; heights are shifted so that the lowest node is at 0.
// Struts are straight in the unrolled plane (angle, height); other curves are given by further nodes. Lengths
// mm.
#pragma once

#include <filesystem>

#include "frame.hpp"

namespace valsalva::stent {

/// InputError names the file and the entry: not JSON, another format, a missing or wrongly shaped entry, and
/// everything that frame_from_struts refuses.
Frame read_graph(const std::filesystem::path& file, int beams_per_strut);

/// The text of a graph file of this frame, beams joined to struts again. The curve of a strut between its
/// crossings is lost.
std::string graph_text(const Frame& frame);

}  // namespace valsalva::stent
