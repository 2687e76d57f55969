#include "scene/scene.hpp"

namespace valsalva {

void declare_contact(Schema& schema) {
  schema.table("contact", "Contact between bodies while the device is crimped");
  schema.choice("contact.law", "barrier", {"barrier", "penalty"},
                "Pressure over distance: a barrier grows without bound, a penalty is bounded (to compare)");
  schema.real("contact.modulus_kPa", 1000, positive(),
              "Stiffness scale of the law; the barrier gives 1.2 times this at half the contact distance");
  schema.real("contact.strut_modulus_kPa", 10000, positive(), "The same where a strut takes part");
  schema.real(
      "contact.tissue_compressed_thickness_fraction", 0.4, {0.05, 1},
      "Thickness of tissue in contact over its thickness at rest: pericardium is squeezed and gives off "
      "water when crimped (assumed: the largest that fits, docs/crimp.md)");
  schema.real(
      "contact.rest_factor", 0.9, {0.1, 1},
      "Contact starts at most at this share of the distance that two places have in the assembled device");
  schema.real("contact.wide_skin_mm", 0.3, {0.02, 2}, "Reach of the wide candidate list beyond contact");
  schema.real("contact.near_skin_mm", 0.05, {0.005, 1}, "Reach of the near candidate list beyond contact");
}

}  // namespace valsalva
