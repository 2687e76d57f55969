// What happens on the six sides of the box, and the ghost values that say so.
//
//   periodic   both sides of a direction
//   slip       normal velocity 0, no shear
//   wall       normal velocity 0, tangential velocity that of the wall (`velocity`)
//   open       (z only) a reservoir at the prescribed pressure p stands beyond the side (below)
//   inflow     (z only) normal velocity prescribed face by face, tangential velocity 0
//
// Open sides. What leaves does so against the pressure p, with zero gradient of velocity. What enters comes
// from rest in the reservoir: its total pressure is p, so that face by face
//   static pressure on the side = p - rho w^2 / 2,    tangential velocity 0,   no viscosity
// Convection then brings in no kinetic energy: the flow takes at most p Q from the reservoir, and cannot grow
// without bound. (The velocity-based stabilisation in Bertoglio et al. 2018, "Benchmark problems for
// numerical treatment of backflow at open boundaries", with beta = 1. With the static pressure prescribed
// instead, a stream that widens behind the side recovers pressure in proportion to w^2, sucks itself in by it
// and blows up in finite time: docs/decisions/fluid.md.)
//
// Open and inflow sides take effect inside the lumen; what a level set or body covers stays at rest.
#pragma once

#include <array>

#include "core/types.hpp"
#include "fluid/grid.hpp"

namespace valsalva::fluid {

enum class Side { periodic, slip, wall, open, inflow };
enum class End { low = 0, high = 1 };  ///< of the z-axis

struct Boundaries {
  std::array<std::array<Side, 2>, 3> side{
      {{Side::slip, Side::slip}, {Side::slip, Side::slip}, {Side::open, Side::open}}};
  /// mm/s, of walls; only its tangential part counts.
  std::array<std::array<Vec3, 2>, 3> velocity{
      {{Vec3::Zero(), Vec3::Zero()}, {Vec3::Zero(), Vec3::Zero()}, {Vec3::Zero(), Vec3::Zero()}}};

  bool periodic(int d) const { return side[d][0] == Side::periodic; }
  Side end(End end) const { return side[2][static_cast<int>(end)]; }
  /// InputError: one side periodic and the other not; open or inflow in x or y.
  void check() const;
};

/// Copies planes between neighbouring slabs (and around a periodic z): `layers` ghost planes on both sides.
void exchange_planes(const Slab& slab, Field& field, int layers);

/// Adds what was written into ghost planes, columns and rows of periodic sides to their owners (spread
/// forces).
void accumulate_ghosts(const Slab& slab, const Boundaries& boundaries, FaceField& field);

/// All ghosts of a velocity, and the normal velocity on walls and slip sides.
void fill_velocity_ghosts(const Slab& slab, const Boundaries& boundaries, FaceField& velocity);

/// One ghost layer of a pressure: mirrored at walls and inflow, 2 p_end - p at open ends.
void fill_pressure_ghosts(const Slab& slab, const Boundaries& boundaries, Field& pressure,
                          const std::array<double, 2>& end_pressure);

/// `layers` ghost layers of a field in a box that is periodic in all directions.
void fill_periodic_ghosts(const Slab& slab, Field& field, int layers);

}  // namespace valsalva::fluid
