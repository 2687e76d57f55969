#include "fluid/boundary.hpp"

#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::fluid {

namespace {

struct Line {
  double* base;      ///< entry 0 of the line
  std::ptrdiff_t s;  ///< stride along the direction
  int n;             ///< cells along the direction
};

// The ghosts of one line (or, with `width` > 1, of `width` neighbouring lines) beyond one side.
// `normal`: the component is normal to the side, hence a face lies on it. given(i): the velocity of wall or
// inflow for the line i. owned: the high side's face is an entry of the field.
template <class Given>
void fill_side(const Line& line, int width, int side, Side kind, bool normal, bool owned,
               const Given& given) {
  const int n = line.n;
  const auto at = [&line](int m) { return line.base + m * line.s; };
  const auto set = [width](double* to, double factor, const double* from) {
    for (int i = 0; i < width; ++i) to[i] = factor * from[i];
  };
  const bool high = side == 1;
  if (kind == Side::periodic) {
    for (int m = 0; m < ghosts; ++m) {
      if (high) {
        set(at(n + m), 1, at(m));
      } else {
        set(at(-1 - m), 1, at(n - 1 - m));
      }
    }
  } else if (normal && kind == Side::inflow) {
    // Linear continuation, of the two the one that damps: next to an entrance the flux of fourth order
    // becomes that of second, next to an exit it keeps its order.
    const double inwards = high ? -1 : 1;
    double* face = at(high ? n : 0);
    const double *near = at(high ? n - 1 : 1), *far = at(high ? n - 2 : 2);
    for (int i = 0; high && !owned && i < width; ++i) face[i] = given(i);
    for (int m = 1; m <= (high ? ghosts - 1 : ghosts); ++m) {
      double* to = at(high ? n + m : -m);
      for (int i = 0; i < width; ++i)
        to[i] = face[i] + m * (inwards * face[i] > 0 ? near[i] - far[i] : face[i] - near[i]);
    }
  } else if (normal) {
    const int face = high ? n : 0;
    const double sign = kind == Side::slip ? -1 : 1;  // u ~ x at a slip side, u ~ x^2 at a wall
    std::fill_n(at(face), width, 0.0);
    const int layers = high ? ghosts - 1 : ghosts;
    for (int m = 1; m <= layers; ++m)
      set(at(high ? face + m : face - m), sign, at(high ? face - m : face + m));
  } else {
    const double sign = kind == Side::slip ? 1 : -1, share = kind == Side::slip ? 0 : 2;
    for (int m = 0; m < ghosts; ++m) {
      double* to = at(high ? n + m : -1 - m);
      const double* from = at(high ? n - 1 - m : m);
      for (int i = 0; i < width; ++i) to[i] = sign * from[i] + share * given(i);
    }
  }
}

// Open end, tangential component d: zero gradient where the flow leaves, 0 where it enters.
void fill_open_tangential(const Slab& slab, int d, int side, const Field& w, Field& field) {
  const int n = slab.planes;
  const int face = side == 1 ? n : 0;
  const int inner = side == 1 ? n - 1 : 0;
  const std::ptrdiff_t s = d == 0 ? 1 : slab.stride_y;
  const double outward = side == 1 ? 1 : -1;
  const int nx = slab.grid.cells[0], ny = slab.grid.cells[1];
  // From one row and column inside the array's edge, where the mean of two w exists.
  for (int j = 1 - ghosts; j < ny + ghosts; ++j) {
    for (int i = 1 - ghosts; i < nx + ghosts; ++i) {
      const double* at = w.row(j, face) + i;
      const double value = outward * (at[0] + at[-s]) >= 0 ? field(i, j, inner) : 0;
      for (int m = 0; m < ghosts; ++m) field(i, j, side == 1 ? n + m : -1 - m) = value;
    }
  }
}

void copy_plane(const Slab& slab, Field& field, int from, int to) {
  const double* source = field.data().data() + field.index(-ghosts, -ghosts, from);
  std::copy_n(source, slab.stride_z, field.data().data() + field.index(-ghosts, -ghosts, to));
}

void fill_end(const Slab& slab, const Boundaries& boundaries, int side, FaceField& velocity) {
  const Side kind = boundaries.side[2][side];
  const int n = slab.planes;
  for (int d = 0; d < 3; ++d) {
    Field& field = velocity[d];
    const Line line{field.row(-ghosts, 0) - ghosts, slab.stride_z, n};
    const int width = static_cast<int>(slab.stride_z);
    if (kind == Side::open) {
      if (d == 2) {
        for (int m = 1; m <= (side == 1 ? ghosts - 1 : ghosts); ++m) {
          copy_plane(slab, field, side == 1 ? n : 0, side == 1 ? n + m : -m);
        }
      } else {
        fill_open_tangential(slab, d, side, velocity[2], field);
      }
    } else if (kind == Side::inflow) {
      const SideVelocity& given = boundaries.inflow[2][side];
      const int stride = static_cast<int>(slab.stride_y);
      fill_side(line, width, side, kind, d == 2, true,
                [&](int i) { return given.at(d, i % stride - ghosts, i / stride - ghosts); });
    } else {
      const double wall = boundaries.velocity[2][side][d];
      fill_side(line, width, side, kind, d == 2, true, [=](int) { return wall; });
    }
  }
}

}  // namespace

void Boundaries::check() const {
  for (int d = 0; d < 3; ++d) {
    if ((side[d][0] == Side::periodic) != (side[d][1] == Side::periodic)) {
      throw InputError(
          "fluid boundaries: one side along {} is periodic and the other is not; make both periodic",
          "xyz"[d]);
    }
    for (Side kind : side[d]) {
      if (d < 2 && kind == Side::open) {
        throw InputError("fluid boundaries: an open side along {}; only the ends in z can be open", "xyz"[d]);
      }
    }
  }
}

void exchange_planes(const Slab& slab, Field& field, int layers) {
  const std::ptrdiff_t count = layers * slab.stride_z;
  double* base = field.data().data();
  double* below = base + (ghosts - layers) * slab.stride_z;
  double* lowest = base + ghosts * slab.stride_z;
  double* above = base + (slab.planes + ghosts) * slab.stride_z;
  double* highest = above - count;
  if (slab.ranks == 1) {
    for (int m = 0; slab.periodic_z && m < layers; ++m) {
      const std::ptrdiff_t back = (layers - 1 - m) * slab.stride_z, on = m * slab.stride_z;
      std::copy_n(highest + back, slab.stride_z, below + back);
      std::copy_n(lowest + on, slab.stride_z, above + on);
    }
    return;
  }
  const bool has_lower = slab.periodic_z || !slab.is_lowest();
  const bool has_upper = slab.periodic_z || !slab.is_highest();
  const int lower = has_lower ? (slab.rank + slab.ranks - 1) % slab.ranks : MPI_PROC_NULL;
  const int upper = has_upper ? (slab.rank + 1) % slab.ranks : MPI_PROC_NULL;
  const int n = static_cast<int>(count);
  MPI_Sendrecv(lowest, n, MPI_DOUBLE, lower, 0, above, n, MPI_DOUBLE, upper, 0, slab.comm, MPI_STATUS_IGNORE);
  MPI_Sendrecv(highest, n, MPI_DOUBLE, upper, 1, below, n, MPI_DOUBLE, lower, 1, slab.comm,
               MPI_STATUS_IGNORE);
}

void fill_velocity_ghosts(const Slab& slab, const Boundaries& boundaries, FaceField& velocity) {
  const int nx = slab.grid.cells[0], ny = slab.grid.cells[1];
  for (int d = 0; d < 3; ++d) {
    Field& field = velocity[d];
    const int planes = d == 2 ? slab.w_planes() : slab.planes;
    for (int k = 0; k < planes; ++k) {
      for (int side = 0; side < 2; ++side) {
        const Side kind = boundaries.side[0][side];
        const SideVelocity& inflow = boundaries.inflow[0][side];
        const double wall = boundaries.velocity[0][side][d];
        for (int j = 0; j < ny; ++j) {
          const double given = kind == Side::inflow ? inflow.at(d, j, k) : wall;
          fill_side({field.row(j, k), 1, nx}, 1, side, kind, d == 0, false, [=](int) { return given; });
        }
      }
      for (int side = 0; side < 2; ++side) {
        const Side kind = boundaries.side[1][side];
        const Line line{field.row(0, k) - ghosts, slab.stride_y, ny};
        const int width = static_cast<int>(slab.stride_y);
        if (kind == Side::inflow) {
          const SideVelocity& inflow = boundaries.inflow[1][side];
          fill_side(line, width, side, kind, d == 1, false,
                    [&](int i) { return inflow.at(d, i - ghosts, k); });
        } else {
          const double wall = boundaries.velocity[1][side][d];
          fill_side(line, width, side, kind, d == 1, false, [=](int) { return wall; });
        }
      }
    }
    exchange_planes(slab, field, ghosts);
  }
  if (slab.periodic_z) return;
  if (slab.is_lowest()) fill_end(slab, boundaries, 0, velocity);
  if (slab.is_highest()) fill_end(slab, boundaries, 1, velocity);
}

void fill_pressure_ghosts(const Slab& slab, const Boundaries& boundaries, Field& pressure,
                          const std::array<double, 2>& end_pressure) {
  const int nx = slab.grid.cells[0], ny = slab.grid.cells[1], nz = slab.planes;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      double* row = pressure.row(j, k);
      row[-1] = boundaries.periodic(0) ? row[nx - 1] : row[0];
      row[nx] = boundaries.periodic(0) ? row[0] : row[nx - 1];
    }
    const double* below = pressure.row(boundaries.periodic(1) ? ny - 1 : 0, k);
    const double* above = pressure.row(boundaries.periodic(1) ? 0 : ny - 1, k);
    std::copy_n(below - 1, nx + 2, pressure.row(-1, k) - 1);
    std::copy_n(above - 1, nx + 2, pressure.row(ny, k) - 1);
  }
  exchange_planes(slab, pressure, 1);
  if (slab.periodic_z) return;
  for (int side = 0; side < 2; ++side) {
    if (side == 0 ? !slab.is_lowest() : !slab.is_highest()) continue;
    const int inner = side == 0 ? 0 : nz - 1, ghost = side == 0 ? -1 : nz;
    const bool open = boundaries.side[2][side] == Side::open;
    const double factor = open ? -1 : 1, shift = open ? 2 * end_pressure[side] : 0;
    for (int j = -1; j <= ny; ++j) {
      const double* from = pressure.row(j, inner);
      double* to = pressure.row(j, ghost);
      for (int i = -1; i <= nx; ++i) to[i] = factor * from[i] + shift;
    }
  }
}

void fill_periodic_ghosts(const Slab& slab, Field& field, int layers) {
  const int nx = slab.grid.cells[0], ny = slab.grid.cells[1];
  for (int k = 0; k < slab.planes; ++k) {
    for (int j = 0; j < ny; ++j) {
      double* row = field.row(j, k);
      for (int m = 0; m < layers; ++m) {
        row[-1 - m] = row[nx - 1 - m];
        row[nx + m] = row[m];
      }
    }
    for (int m = 0; m < layers; ++m) {
      std::copy_n(field.row(ny - 1 - m, k) - ghosts, slab.stride_y, field.row(-1 - m, k) - ghosts);
      std::copy_n(field.row(m, k) - ghosts, slab.stride_y, field.row(ny + m, k) - ghosts);
    }
  }
  exchange_planes(slab, field, layers);
}

}  // namespace valsalva::fluid
