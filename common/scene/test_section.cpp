#include "scene/scene.hpp"

namespace valsalva {

void declare_test_section(Schema& schema) {
  schema.table("test_section",
               "A vessel given by formula, in which [[body]] entries stand: one shell that moves with the "
               "blood, rigid bodies that hold it; no anatomy and no earlier stage");
  schema.reals("test_section.z_mm", {}, 0, unlimited(),
               "Heights at which the radius is given, ascending; the first and the last are the open ends. "
               "The valve's lowest point is usually 0, +z downstream");
  schema.reals("test_section.radius_mm", {}, 0, positive(),
               "Radius at each of these heights, linear between");
  schema.real("test_section.sinus_depth_mm", 0, not_negative(),
              "Three sinuses: how far they reach beyond that radius");
  schema.reals("test_section.sinus_z_mm", {0, 0}, 2, unlimited(), "Where the sinuses begin and end");
  schema.real("test_section.sinus_angle_deg", 0, {-180, 180}, "Azimuth of the middle of the first sinus");
  schema.real("test_section.sample_mm", 0.5, {0.1, 2}, "Sample spacing of the vessel's level set");
}

}  // namespace valsalva
