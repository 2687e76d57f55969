#include "fluid/wall_upwind.hpp"

#include <cmath>

#include "core/mpi.hpp"

namespace valsalva::fluid {

namespace {

std::array<int, 3> moved(std::array<int, 3> face, int along, int by) {
  face[along] += by;
  return face;
}

}  // namespace

// solid: 1 at held faces, with two ghost planes in z.
WallUpwind::Kind WallUpwind::kind(const Field& solid, int d, std::array<int, 3> face) const {
  for (int e = 0; e < 3; ++e) {
    const int n = slab_.grid.cells[e], at = face[e] + (e == 2 ? slab_.first : 0);
    if (boundaries_.periodic(e)) {
      if (e < 2) face[e] = (at + n) % n;
      continue;
    }
    const int high = d == e ? n : n - 1;
    if (at < 0 || at > high)
      return boundaries_.side[e][at < 0 ? 0 : 1] == Side::wall ? Kind::beyond_wall : Kind::beyond;
    if (d == e && (at == 0 || at == high))
      return boundaries_.side[e][at == 0 ? 0 : 1] == Side::wall ? Kind::beyond_wall : Kind::prescribed;
  }
  return solid(face[0], face[1], face[2]) != 0 ? Kind::solid : Kind::fluid;
}

bool WallUpwind::beside_wall(const Field& solid, int d, const std::array<int, 3>& face) const {
  for (int e = 0; e < 3; ++e) {
    for (const int by : {-1, 1}) {
      const Kind found = kind(solid, d, moved(face, e, by));
      if (found == Kind::solid || found == Kind::beyond_wall) return true;
    }
  }
  return false;
}

void WallUpwind::update(const Solids& solids) {
  if (!mpi::any(slab_.comm, version_ != solids.version())) return;
  version_ = solids.version();
  const auto& cells = slab_.grid.cells;
  for (int d = 0; d < 3; ++d) {
    Field solid(slab_);
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < cells[1]; ++j) {
        for (int i = 0; i < cells[0]; ++i) solid(i, j, k) = solids.owner(d, i, j, k) != 0 ? 1 : 0;
      }
    }
    exchange_planes(slab_, solid, 2);
    faces_[d].clear();
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < cells[1]; ++j) {
        for (int i = 0; i < cells[0]; ++i) {
          if (kind(solid, d, {i, j, k}) != Kind::fluid) continue;
          const bool here = beside_wall(solid, d, {i, j, k});
          std::uint8_t sides = 0;
          for (int side = 0; side < 6; ++side) {
            const std::array<int, 3> other = moved({i, j, k}, side / 2, side % 2 == 0 ? -1 : 1);
            const Kind found = kind(solid, d, other);
            const bool joined = found == Kind::fluid || found == Kind::prescribed;
            if (joined && (here || (found == Kind::fluid && beside_wall(solid, d, other))))
              sides |= static_cast<std::uint8_t>(1 << side);
          }
          if (sides != 0) faces_[d].push_back({solid.index(i, j, k), sides});
        }
      }
    }
  }
}

void WallUpwind::add(const FaceField& velocity, double weight, FaceField& rate, FaceField& next) const {
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  const double quarter_per_h = 0.25 / slab_.grid.h;  // half of the mean of two velocities
  for (int d = 0; d < 3; ++d) {
    const double* q = velocity[d].data().data();
    double* n = rate[d].data().data();
    double* out = next[d].data().data();
    const std::ptrdiff_t sd = stride[d];
    for (const auto& [at, sides] : faces_[d]) {
      double change = 0;
      for (int e = 0; e < 3; ++e) {
        const double* a = velocity[e].data().data() + at;
        const std::ptrdiff_t se = stride[e];
        if (sides >> (2 * e) & 1) change += std::abs(a[0] + a[-sd]) * (q[at - se] - q[at]);
        if (sides >> (2 * e + 1) & 1) change += std::abs(a[se] + a[se - sd]) * (q[at + se] - q[at]);
      }
      n[at] += quarter_per_h * change;
      out[at] += weight * quarter_per_h * change;
    }
  }
}

}  // namespace valsalva::fluid
