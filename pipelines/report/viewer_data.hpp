// The data of the interactive view, as JSON for page/viewer.js.
//
// Positions are 16-bit integers on a grid over each body's own box (a 100 mm body: 1.5 micrometres),
// triangles 32-bit indices, both little-endian in base64. The beat: positions of the moving valve and speed
// in the slice (8 bits; 0 marks samples outside the lumen) for up to `frames` frames.
#pragma once

#include <string>

#include "run_data.hpp"

namespace valsalva::report {

/// "{}" when no state holds a body.
std::string viewer_json(const RunData& run, int frames);

}  // namespace valsalva::report
