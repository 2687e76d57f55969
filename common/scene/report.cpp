#include "scene/scene.hpp"

namespace valsalva {

void declare_report(Schema& schema) {
  schema.table("report", "The page that tells the story of a run");
  schema.integer("report.picture_width_px", 680, {200, 4000}, "Width of a still picture in pixels");
  schema.integer("report.viewer_frames", 40, {2, 400},
                 "At most so many frames of the beat in the interactive view; more make the page larger");
}

}  // namespace valsalva
