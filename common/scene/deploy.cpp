#include "scene/scene.hpp"

namespace valsalva {

void declare_deploy(Schema& schema) {
  schema.table("deploy", "Placing the crimped device, opening the native leaflets, release and settling");
  schema.real("deploy.depth_mm", 5, {-10, 20}, "Commanded depth of the skirt's edge below the annulus plane");
  schema.real("deploy.rotation_deg", 0, {-360, 360}, "Turn of the device about its axis");
  schema.choice("deploy.release", "all_at_once", {"all_at_once", "sheath"},
                "Release the whole frame at one moment, or draw a sheath back along +z");
  schema.real("deploy.sheath_speed_mm_per_s", 600, positive(), "Speed at which the sheath is drawn back");
  schema.real("deploy.sheath_clearance_mm", 0.05, {0, 2},
              "Radial play between the crimped device and the sheath");

  schema.real("deploy.open_pressure_mmHg", 750, not_negative(),
              "Pressure on the underside of the native leaflets that opens them (Brown et al. 2022)");
  schema.real("deploy.open_ramp_ms", 10, positive(), "The pressure rises over this time");
  schema.real("deploy.open_hold_ms", 6, not_negative(), "and is held this long before the device is placed");
  schema.real("deploy.open_damping_per_s", 400, not_negative(),
              "Mass-proportional damping while the leaflets open (stands for the fluid; assumed)");

  schema.real("deploy.expand_ms", {50, 60, 80, 100}, positive(),
              "Duration of expansion under release damping (all at once; a sheath sets its own time)");
  schema.real("deploy.release_damping_per_s", 700, not_negative(),
              "Mass-proportional damping during expansion: the delivery system's friction (assumed)");
  schema.real("deploy.settle_ms", {40, 60, 80, 100}, positive(),
              "Duration of settling; pressure and hold are taken away over its first half");
  schema.real("deploy.settle_damping_per_s", 500, not_negative(), "Mass-proportional damping while settling");
  schema.real(
      "deploy.hold_stiffness_N_per_mm", 20, not_negative(),
      "The delivery system holds the skirt's edge at its depth with this stiffness until settling; 0: free");
  schema.real("deploy.step_us", {10, 6, 4, 3}, positive(), "Time step; masses are scaled to it");

  schema.real("deploy.wall_friction", 0.3, {0, 2}, "Coulomb friction between device and wall (assumed)");
  schema.real(
      "deploy.wall_stiffness_kPa_per_mm", 10000, positive(),
      "Pressure of the wall per overlap on struts: sets the contact tolerance, not the wall's compliance");
  schema.real("deploy.tissue_wall_stiffness_kPa_per_mm", 15000, positive(), "The same on leaflets and skirt");
  schema.real(
      "deploy.contact_modulus_kPa", 200, positive(),
      "Stiffness scale of contact between bodies (docs of contact; reached at half the contact distance)");
  schema.real(
      "deploy.native_self_distance_mm", 0.25, positive(),
      "Distance at which folds of the native leaflets meet each other: half their edge length, since a "
      "larger one makes every node a neighbour of its own surroundings");
  schema.real("deploy.tie_stiffness_N_per_mm", 5, positive(), "Stiffness of a stitch");
  schema.real("deploy.penetration_tolerance_mm", 0.2, positive(),
              "Largest overlap that counts as touching: about half a tissue thickness (assumed)");
  schema.real("deploy.apposition_gap_mm", 0.5, positive(),
              "A part of the skirt further than this from wall and native leaflets is a gap");
}

}  // namespace valsalva
