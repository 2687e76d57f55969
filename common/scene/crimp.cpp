#include "scene/scene.hpp"

namespace valsalva {

void declare_crimp(Schema& schema) {
  schema.table("crimp", "Closing the device in a cylindrical crimper, dry");
  schema.real(
      "crimp.diameter_mm", 5.7, {1, 60},
      "Final inner diameter of the crimper; the device is larger by its contact overlap, some 0.02 mm");
  schema.real("crimp.speed_mm_per_s", 500, {1, 5000}, "Radial speed of the crimper (Brown et al. 2022: 500)");
  schema.real("crimp.ramp_ms", 12, {0.01, 100}, "The crimper starts and stops smoothly over this time");
  schema.real("crimp.settle_ms", 20, {0, 500}, "At most this long the device rests in the closed crimper");
  schema.real("crimp.settled_energy_ratio", 1e-4, positive(),
              "Rest is over when kinetic energy falls below this share of internal energy");
  schema.real("crimp.step_us", {1.6, 1.2, 0.8, 0.6}, positive(), "Time step; masses are scaled to it");
  schema.integer("crimp.scaling_interval", 5, {1, 1000}, "Steps between new mass scalings");
  schema.real("crimp.damping_per_s", 100, not_negative(),
              "Mass-proportional damping while closing (assumed)");
  schema.real("crimp.settle_damping_per_s", 2000, not_negative(), "The same while resting (assumed)");
  schema.real(
      "crimp.tissue_damping_per_s", 10000, not_negative(),
      "Rate of the dashpots along the edges of tissue triangles: takes out ringing between nodes (assumed)");
  schema.real(
      "crimp.crimper_stiffness_kPa_per_mm", 1000000, positive(),
      "Pressure of the crimper per overlap on struts: sets the overlap, not the crimper's compliance");
  schema.real("crimp.crimper_tissue_stiffness_kPa_per_mm", 200000, positive(),
              "The same on tissue: light nodes chatter on a stiffer crimper");
  schema.real("crimp.crimper_friction", 0, {0, 2},
              "Coulomb friction between device and crimper; 0: the sleeve slides freely");
  schema.real("crimp.tie_stiffness_N_per_mm", 5, positive(), "Stiffness of a stitch");
  schema.real("crimp.asymmetry_mm", 0.01, {0, 0.1},
              "Tissue nodes start displaced by up to this length, the same in every run, so that folds "
              "choose a side");
  schema.integer("crimp.history_interval", 50, {1, 100000}, "Steps between rows of history.csv");
}

}  // namespace valsalva
