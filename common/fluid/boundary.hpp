// What happens on the six sides of the box, and the ghost values that say so.
//
//   periodic   both sides of a direction
//   slip       normal velocity 0, no shear
//   wall       normal velocity 0, tangential velocity that of the wall (`velocity`)
//   open       (z only) a reservoir at the prescribed pressure p stands beyond the side (below)
//   inflow     all components of the velocity prescribed, place by place (`inflow`): an entrance, or any side
//              with a known velocity, which continues linearly beyond it
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

#include <algorithm>
#include <array>
#include <variant>
#include <vector>

#include "core/types.hpp"
#include "fluid/grid.hpp"

namespace valsalva::fluid {

enum class Side { periodic, slip, wall, open, inflow };
enum class End { low = 0, high = 1 };  ///< of the z-axis

/// Where the pressure is known: an open end, or the number of an opening (openings.hpp).
using PressurePlace = std::variant<End, int>;
struct PressureRise {
  PressurePlace place;
  double by = 0;  ///< Pa
};

/// Velocity on one side of the box, mm/s: component d where its field has entries, projected on the side.
/// Of one rank; a and b count along the two other axes, the lower axis first, from the slab's first entry on.
struct SideVelocity {
  std::array<int, 2> extent{0, 0};
  std::array<std::vector<double>, 3> value;  ///< a fastest; empty: zero
  double at(int d, int a, int b) const {
    if (value[d].empty()) return 0;
    return value[d][static_cast<std::size_t>(std::clamp(b, 0, extent[1] - 1)) * extent[0] +
                    std::clamp(a, 0, extent[0] - 1)];
  }
};

struct Boundaries {
  std::array<std::array<Side, 2>, 3> side{
      {{Side::slip, Side::slip}, {Side::slip, Side::slip}, {Side::open, Side::open}}};
  /// mm/s, of walls; only its tangential part counts.
  std::array<std::array<Vec3, 2>, 3> velocity{
      {{Vec3::Zero(), Vec3::Zero()}, {Vec3::Zero(), Vec3::Zero()}, {Vec3::Zero(), Vec3::Zero()}}};

  /// Of inflow sides; Flow fills them.
  std::array<std::array<SideVelocity, 2>, 3> inflow;

  bool periodic(int d) const { return side[d][0] == Side::periodic; }
  Side end(End end) const { return side[2][static_cast<int>(end)]; }
  /// InputError: one side periodic and the other not; open in x or y.
  void check() const;
};

/// Copies planes between neighbouring slabs (and around a periodic z): `layers` ghost planes on both sides.
void exchange_planes(const Slab& slab, Field& field, int layers);

/// All ghosts of a velocity, and the normal velocity on walls and slip sides.
void fill_velocity_ghosts(const Slab& slab, const Boundaries& boundaries, FaceField& velocity);

/// One ghost layer of a pressure: mirrored at walls and inflow, 2 p_end - p at open ends.
void fill_pressure_ghosts(const Slab& slab, const Boundaries& boundaries, Field& pressure,
                          const std::array<double, 2>& end_pressure);

/// `layers` ghost layers of a field in a box that is periodic in all directions.
void fill_periodic_ghosts(const Slab& slab, Field& field, int layers);

}  // namespace valsalva::fluid
