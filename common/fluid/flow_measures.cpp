#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "fluid/flow.hpp"

namespace valsalva::fluid {

namespace {

// The owned local plane of w with the whole grid's index `plane`, or -1. Every plane has one owner.
int local_w_plane(const Slab& slab, int plane) {
  VALSALVA_ASSERT(plane >= 0 && plane <= slab.grid.cells[2]);
  const int wrapped = slab.periodic_z ? plane % slab.grid.cells[2] : plane;
  const int local = wrapped - slab.first;
  return local >= 0 && local < slab.w_planes() ? local : -1;
}

}  // namespace

double Flow::outflow(int axis, int side) const {
  const Grid& grid = slab_.grid;
  const int p = axis == 0 ? 1 : 0, q = axis == 2 ? 1 : 2;
  double sum = 0;
  if (has_side(axis, side)) {
    std::array<int, 3> at{0, 0, 0};
    at[axis] = side == 0 ? 0 : axis == 2 ? slab_.planes : grid.cells[axis];
    for (at[q] = 0; at[q] < (q == 2 ? slab_.planes : grid.cells[q]); ++at[q]) {
      for (at[p] = 0; at[p] < grid.cells[p]; ++at[p]) {
        // What faces carry beyond openings, and those that the interpolated wall closes, is no flow.
        if (!(krylov_ || solids_.interpolated()) || !solid_at_side(axis, side, at[p], at[q]))
          sum += velocity_[axis](at[0], at[1], at[2]);
      }
    }
  }
  return (side == 0 ? -1 : 1) * mpi::sum(slab_.comm, sum) * grid.h * grid.h;
}

double Flow::flow_through(int plane) const {
  const Grid& grid = slab_.grid;
  const int k = local_w_plane(slab_, plane);
  double sum = 0;
  if (k >= 0) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      const std::uint8_t* owner = solids_.owner_row(2, j, k);
      const double* w = velocity_[2].row(j, k);
      for (int i = 0; i < grid.cells[0]; ++i) sum += owner[i] == 0 ? w[i] : 0;
    }
  }
  return mpi::sum(slab_.comm, sum * grid.h * grid.h);
}

double Flow::open_area(int plane) const {
  const Grid& grid = slab_.grid;
  const int k = local_w_plane(slab_, plane);
  long count = 0;
  if (k >= 0) {
    const std::uint8_t* owner = solids_.owner_row(2, 0, k);
    count = std::count(owner, owner + grid.plane_cells(), std::uint8_t{0});
  }
  return mpi::sum(slab_.comm, static_cast<double>(count)) * grid.h * grid.h;
}

double Flow::mean_pressure(int plane) const {
  const Grid& grid = slab_.grid;
  VALSALVA_ASSERT(plane >= 0 && plane < grid.cells[2]);
  double sum = 0, count = 0;
  const int k = plane - slab_.first;
  if (k >= 0 && k < slab_.planes) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      const std::uint8_t* owner = solids_.owner_row(3, j, k);
      const double* p = pressure_.row(j, k);
      for (int i = 0; i < grid.cells[0]; ++i) {
        sum += owner[i] == 0 ? p[i] : 0;
        count += owner[i] == 0 ? 1 : 0;
      }
    }
  }
  sum = mpi::sum(slab_.comm, sum);
  count = mpi::sum(slab_.comm, count);
  if (count == 0) {
    throw InputError("fluid: no open cell in the plane z = {:.2f} mm; move the plane into the lumen",
                     grid.position(3, 0, 0, plane)[2]);
  }
  return sum / count;
}

int Flow::plane_at(double z) const {
  const Grid& grid = slab_.grid;
  return static_cast<int>(
      std::clamp(std::lround((z - grid.origin[2]) / grid.h), 0L, static_cast<long>(grid.cells[2])));
}

double Flow::kinetic_energy() const {
  const Grid& grid = slab_.grid;
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        const double* u = velocity_[d].row(j, k);
        if (krylov_) {
          const std::uint8_t* owner = solids_.owner_row(d, j, k);
          for (int i = 0; i < grid.cells[0]; ++i) sum += owner[i] == 0 ? u[i] * u[i] : 0;
        } else {
          for (int i = 0; i < grid.cells[0]; ++i) sum += u[i] * u[i];
        }
      }
    }
  }
  return mpi::sum(slab_.comm, 0.5 * parameters_.density * std::pow(grid.h, 3) * sum);
}

double Flow::divergence() const {
  const Grid& grid = slab_.grid;
  double largest = 0;
  if (parameters_.order == 4) {
    std::vector<double> plane(grid.plane_cells());
    for (int k = 0; k < slab_.planes; ++k) {
      fill_source_fourth_order(k, 1 / parameters_.density, {plane.data(), slab_.grid.cells[0]});
      for (double value : plane) largest = std::max(largest, std::abs(value));
    }
    return mpi::max(slab_.comm, largest);
  }
  for (int k = 0; k < slab_.planes; ++k) {
    auto cut = solids_.cut_cells(k).begin();
    const auto last_cut = solids_.cut_cells(k).end();
    for (int j = 0; j < grid.cells[1]; ++j) {
      const double* u = velocity_[0].row(j, k);
      const double* v = velocity_[1].row(j, k);
      const double* w = velocity_[2].row(j, k);
      for (int i = 0; i < grid.cells[0]; ++i) {
        double sum = (u[i + 1] - u[i]) + (v[i + slab_.stride_y] - v[i]) + (w[i + slab_.stride_z] - w[i]);
        if (cut != last_cut && cut->place == j * grid.cells[0] + i) {
          sum = cut->difference({u + i, v + i, w + i}, {1, slab_.stride_y, slab_.stride_z});
          ++cut;
        }
        if (krylov_ && !krylov_->solves(i, j, k)) continue;
        largest = std::max(largest, std::abs(sum));
      }
    }
  }
  return mpi::max(slab_.comm, largest / grid.h);
}

Vec3 Flow::momentum() const {
  const Grid& grid = slab_.grid;
  Vec3 sum = Vec3::Zero();
  for (int d = 0; d < 3; ++d) {
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    for (int k = 0; k < planes; ++k) {
      // Faces on an end of the box have half a cell of fluid.
      const bool half =
          d == 2 && !slab_.periodic_z && (k + slab_.first == 0 || k + slab_.first == grid.cells[2]);
      for (int j = 0; j < grid.cells[1]; ++j) {
        const double* u = velocity_[d].row(j, k);
        for (int i = 0; i < grid.cells[0]; ++i) sum[d] += half ? 0.5 * u[i] : u[i];
      }
    }
  }
  sum *= parameters_.density * std::pow(grid.h, 3);
  mpi::sum_in_place(slab_.comm, sum.data(), 3);
  return sum;
}

double Flow::sample(const Field& field, int d, const Vec3& x) const {
  const Grid& grid = slab_.grid;
  // The slab that holds the point answers; the ends of the box belong to the slabs there.
  const int plane =
      std::clamp(static_cast<int>(std::floor((x[2] - grid.origin[2]) / grid.h)), 0, grid.cells[2] - 1);
  double value = 0;
  if (plane >= slab_.first && plane < slab_.first + slab_.planes) {
    const Vec3 s = (x - grid.position(d, 0, 0, slab_.first)) / grid.h;
    std::array<int, 3> at;
    Vec3 t;
    for (int e = 0; e < 3; ++e) {
      const int last = e == 2 ? slab_.planes : grid.cells[e];
      at[e] = std::clamp(static_cast<int>(std::floor(s[e])), -1, last - 1);
      t[e] = std::clamp(s[e] - at[e], 0.0, 1.0);
    }
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::array<int, 3> c = at;
      for (int e = 0; e < 3; ++e) {
        const bool up = (corner >> e) & 1;
        weight *= up ? t[e] : 1 - t[e];
        c[e] += up;
      }
      value += weight * field(c[0], c[1], c[2]);
    }
  }
  return value;
}

Vec3 Flow::velocity_at(const Vec3& x) const {
  Vec3 value(sample(velocity_[0], 0, x), sample(velocity_[1], 1, x), sample(velocity_[2], 2, x));
  mpi::sum_in_place(slab_.comm, value.data(), 3);
  return value;
}

double Flow::pressure_at(const Vec3& x) {
  fill_pressure_ghosts(slab_, boundaries_, pressure_, end_pressure_);
  return mpi::sum(slab_.comm, sample(pressure_, 3, x));
}

Vec3 Flow::wrapped(const Vec3& x) const {
  Vec3 out = x;
  for (int e = 0; e < 3; ++e) {
    const double low = grid().low()[e], extent = grid().high()[e] - low;
    if (boundaries_.periodic(e)) out[e] -= extent * std::floor((out[e] - low) / extent);
  }
  return out;
}

std::vector<Vec3> Flow::velocity_at(const Points& points) const {
  std::vector<double> all;
  for (const Vec3& x : points) {
    for (int d = 0; d < 3; ++d) all.push_back(sample_quadratic(d, wrapped(x)));
  }
  mpi::sum_in_place(slab_.comm, all.data(), all.size());
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    out.emplace_back(all[3 * i], all[3 * i + 1], all[3 * i + 2]);
  return out;
}

std::vector<double> Flow::pressure_at(const Points& points) {
  fill_pressure_ghosts(slab_, boundaries_, pressure_, end_pressure_);
  std::vector<double> all;
  for (const Vec3& x : points) all.push_back(sample(pressure_, 3, wrapped(x)));
  mpi::sum_in_place(slab_.comm, all.data(), all.size());
  return all;
}

// Quadratic in each direction, about the nearest face: its error is of third order, so that differences over
// h converge. The rank that holds the point answers.
double Flow::sample_quadratic(int d, const Vec3& x) const {
  const Grid& grid = slab_.grid;
  const int plane =
      std::clamp(static_cast<int>(std::floor((x[2] - grid.origin[2]) / grid.h)), 0, grid.cells[2] - 1);
  double value = 0;
  if (plane >= slab_.first && plane < slab_.first + slab_.planes) {
    const Vec3 s = (x - grid.position(d, 0, 0, slab_.first)) / grid.h;
    std::array<int, 3> at;
    std::array<std::array<double, 3>, 3> weight;
    for (int e = 0; e < 3; ++e) {
      at[e] = std::clamp(static_cast<int>(std::lround(s[e])), 0, e == 2 ? slab_.planes : grid.cells[e]);
      const double t = s[e] - at[e];
      weight[e] = {0.5 * t * (t - 1), 1 - t * t, 0.5 * t * (t + 1)};
    }
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i)
          value += weight[0][i] * weight[1][j] * weight[2][k] *
                   velocity_[d](at[0] + i - 1, at[1] + j - 1, at[2] + k - 1);
      }
    }
  }
  return value;
}

Vec3 Flow::wall_shear_stress(const Vec3& x, const Vec3& normal) const {
  return wall_shear_stress(std::vector<WallPoint>{{x, normal}})[0];
}

std::vector<Vec3> Flow::wall_shear_stress(const std::vector<WallPoint>& walls) const {
  const double a = 1.5 * grid().h;
  Points places;
  for (const auto& [x, normal] : walls) {
    const Vec3 n = normal.normalized();
    for (int m = 1; m <= 3; ++m) places.push_back(x + m * a * n);
  }
  const std::vector<Vec3> u = velocity_at(places);
  std::vector<Vec3> shear;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vec3 n = walls[i].normal.normalized();
    const Vec3 slope = (-2.5 * u[3 * i] + 4 * u[3 * i + 1] - 1.5 * u[3 * i + 2]) / a;
    shear.push_back(parameters_.viscosity * (slope - slope.dot(n) * n));
  }
  return shear;
}

}  // namespace valsalva::fluid
