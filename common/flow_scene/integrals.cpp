#include "flow_scene/integrals.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::flow_scene {

namespace {

using fluid::Field;
using fluid::Flow;
using fluid::Grid;
using fluid::Slab;

template <class Body>
void each_cell(const Flow& flow, const Body& body) {
  const Slab& slab = flow.slab();
  for (int k = 0; k < slab.planes; ++k) {
    for (int j = 0; j < slab.grid.cells[1]; ++j) {
      for (int i = 0; i < slab.grid.cells[0]; ++i) {
        if (flow.solids().owner(3, i, j, k) == 0) body(i, j, k);
      }
    }
  }
}

template <class Body>
void each_face(const Flow& flow, int d, const Body& body) {
  const Slab& slab = flow.slab();
  for (int k = 0; k < (d == 2 ? slab.w_planes() : slab.planes); ++k) {
    for (int j = 0; j < slab.grid.cells[1]; ++j) {
      for (int i = 0; i < slab.grid.cells[0]; ++i) {
        if (flow.solids().owner(d, i, j, k) == 0)
          body(flow.velocity()[d](i, j, k), slab.grid.position(d, i, j, k + slab.first));
      }
    }
  }
}

struct Moments {
  double count = 0, sum = 0, squares = 0, largest = 0;
  void add(double value) {
    count += 1;
    sum += value;
    squares += value * value;
    largest = std::max(largest, std::abs(value));
  }
  void unite(MPI_Comm comm) {
    double all[3] = {count, sum, squares};
    mpi::sum_in_place(comm, all, 3);
    count = all[0];
    sum = all[1];
    squares = all[2];
    largest = mpi::max(comm, largest);
  }
};

// The plane of faces nearest to a place.
int plane_near(const Grid& grid, int axis, double at) {
  const double place = std::round((at - grid.origin[axis]) / grid.h);
  return static_cast<int>(std::clamp(place, 0.0, double(grid.cells[axis])));
}

}  // namespace

Turbulence turbulence(const Flow& flow) {
  const Slab& slab = flow.slab();
  const fluid::FaceField& u = flow.velocity();
  const double h = slab.grid.h, volume = h * h * h, rho = flow.parameters().density;
  const std::ptrdiff_t stride[3] = {1, slab.stride_y, slab.stride_z};
  const fluid::ExtraViscosity* extra = flow.extra_viscosity();
  double sums[3] = {0, 0, 0};
  each_cell(flow, [&](int i, int j, int k) {
    const std::ptrdiff_t at = u[0].index(i, j, k);
    const double* q[3];
    for (int d = 0; d < 3; ++d) q[d] = u[d].data().data() + at;
    double kinetic = 0, strain = 0, rotation = 0;
    for (int d = 0; d < 3; ++d) {
      const double low = q[d][0], high = q[d][stride[d]];
      kinetic += 0.25 * (low * low + high * high);
      strain += (high - low) * (high - low);
    }
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3;
      // The four edges along the third direction; 0 or 1 cells up along d and e.
      for (int edge = 0; edge < 4; ++edge) {
        const std::ptrdiff_t to = (edge & 1) * stride[d] + (edge >> 1) * stride[e];
        const double across = q[d][to] - q[d][to - stride[e]], along = q[e][to] - q[e][to - stride[d]];
        strain += 0.125 * (across + along) * (across + along);
        rotation += 0.25 * (along - across) * (along - across);
      }
    }
    const double mu = flow.parameters().viscosity + (extra ? rho * extra->value().data()[at] : 0);
    sums[0] += rho * kinetic * volume;
    sums[1] += 2 * mu * strain / (h * h) * volume;
    sums[2] += 0.5 * rotation / (h * h) * volume;
  });
  mpi::sum_in_place(slab.comm, sums, 3);
  return {sums[0], sums[1], sums[2]};
}

double section_flow(const Flow& flow, int axis, double at, const Inside& inside) {
  const Slab& slab = flow.slab();
  const Grid& grid = slab.grid;
  const int plane = plane_near(grid, axis, at);
  double sum = 0;
  std::array<int, 3> from{0, 0, 0}, to{grid.cells[0], grid.cells[1], slab.planes};
  from[axis] = plane;
  if (axis == 2) from[2] = (slab.periodic_z ? plane % grid.cells[2] : plane) - slab.first;
  to[axis] = from[axis] + 1;
  if (axis == 2 && (from[2] < 0 || from[2] >= slab.w_planes())) to[2] = from[2];
  // The high sides of x and y: the face belongs to no cell, and is as solid as the cell before it.
  const bool beyond = axis < 2 && plane == grid.cells[axis];
  for (int k = from[2]; k < to[2]; ++k) {
    for (int j = from[1]; j < to[1]; ++j) {
      for (int i = from[0]; i < to[0]; ++i) {
        const int owner = beyond ? flow.solids().owner(3, i - (axis == 0), j - (axis == 1), k)
                                 : flow.solids().owner(axis, i, j, k);
        if (owner == 0 && inside(grid.position(axis, i, j, k + slab.first)))
          sum += flow.velocity()[axis](i, j, k);
      }
    }
  }
  return mpi::sum(slab.comm, sum) * grid.h * grid.h;
}

double section_pressure(const Flow& flow, int axis, double at, const Inside& inside,
                        const std::string& what) {
  const Slab& slab = flow.slab();
  const Grid& grid = slab.grid;
  const int plane = plane_near(grid, axis, at);
  double sums[2] = {0, 0};
  each_cell(flow, [&](int i, int j, int k) {
    const int index = axis == 0 ? i : axis == 1 ? j : k + slab.first;
    if (index != plane && index != plane - 1) return;
    Vec3 x = grid.position(3, i, j, k + slab.first);
    x[axis] = grid.origin[axis] + plane * grid.h;
    if (!inside(x)) return;
    sums[0] += flow.pressure()(i, j, k);
    sums[1] += 1;
  });
  mpi::sum_in_place(slab.comm, sums, 2);
  if (sums[1] == 0) throw InputError("{}: no open cell in the section; move it into the fluid", what);
  return sums[0] / sums[1];
}

Norms velocity_error(const Flow& flow, const std::function<double(int, const Vec3&)>& exact) {
  double squares = 0, largest = 0;
  for (int d = 0; d < 3; ++d) {
    Moments m;
    each_face(flow, d, [&](double u, const Vec3& x) { m.add(u - exact(d, x)); });
    m.unite(flow.slab().comm);
    if (m.count > 0) squares += m.squares / m.count;
    largest = std::max(largest, m.largest);
  }
  return {std::sqrt(squares), largest};
}

Norms pressure_error(const Flow& flow, const std::function<double(const Vec3&)>& exact) {
  const Slab& slab = flow.slab();
  const auto difference = [&](int i, int j, int k) {
    return flow.pressure()(i, j, k) - exact(slab.grid.position(3, i, j, k + slab.first));
  };
  Moments raw;
  each_cell(flow, [&](int i, int j, int k) { raw.add(difference(i, j, k)); });
  raw.unite(slab.comm);
  if (raw.count == 0) return {};
  const double mean = raw.sum / raw.count;
  Moments m;
  each_cell(flow, [&](int i, int j, int k) { m.add(difference(i, j, k) - mean); });
  m.unite(slab.comm);
  return {std::sqrt(m.squares / m.count), m.largest};
}

}  // namespace valsalva::flow_scene
