// The still pictures of the story, each rendered from states of the run.
#pragma once

#include <string>
#include <vector>

#include "bodies.hpp"
#include "html.hpp"
#include "run_data.hpp"

namespace valsalva::report {

/// width: pixels of one picture.
std::vector<Picture> anatomy_pictures(const RunData& run, int width);
std::vector<Picture> mesh_pictures(const RunData& run, int width);
/// Expanded and crimped at one scale, so that they can be compared.
std::vector<Picture> device_pictures(const RunData& run, int width);
std::vector<Picture> deployed_pictures(const RunData& run, int width);
/// Open and closed valve; velocity and pressure in the plane through the axis.
std::vector<Picture> beat_pictures(const RunData& run, int width);

}  // namespace valsalva::report
