#include <algorithm>

#include "core/errors.hpp"
#include "core/units.hpp"
#include "fluid/flow.hpp"

namespace valsalva::fluid {

namespace {

int owned_planes(const Slab& slab, int d) {
  return d == 2 ? slab.w_planes() : slab.planes;
}
int all_planes(const Slab& slab, int d) {
  return slab.grid.cells[2] + (d == 2 && !slab.periodic_z ? 1 : 0);
}

std::vector<double> gather(const Slab& slab, const Field& field, int d) {
  const int nx = slab.grid.cells[0], ny = slab.grid.cells[1];
  const std::size_t plane = slab.grid.plane_cells();
  std::vector<double> own;
  own.reserve(plane * owned_planes(slab, d));
  for (int k = 0; k < owned_planes(slab, d); ++k) {
    for (int j = 0; j < ny; ++j) own.insert(own.end(), field.row(j, k), field.row(j, k) + nx);
  }
  std::vector<int> counts(slab.ranks), at(slab.ranks);
  for (int r = 0; r < slab.ranks; ++r) {
    const int extra = r == slab.ranks - 1 ? all_planes(slab, d) - slab.grid.cells[2] : 0;
    counts[r] = static_cast<int>(plane) * (slab.first_of(r + 1) - slab.first_of(r) + extra);
    at[r] = static_cast<int>(plane) * slab.first_of(r);
  }
  std::vector<double> all(slab.rank == 0 ? plane * all_planes(slab, d) : 0);
  MPI_Gatherv(own.data(), static_cast<int>(own.size()), MPI_DOUBLE, all.data(), counts.data(), at.data(),
              MPI_DOUBLE, 0, slab.comm);
  return all;
}

std::vector<std::size_t> shape_of(const Slab& slab, int d) {
  return {static_cast<std::size_t>(all_planes(slab, d)), static_cast<std::size_t>(slab.grid.cells[1]),
          static_cast<std::size_t>(slab.grid.cells[0])};
}

void scatter(const Slab& slab, const state::State& state, const std::string& name, Field& field, int d) {
  const state::Array& array = state.array(name);
  if (array.shape != shape_of(slab, d)) {
    throw InputError(
        "{}: {} does not have the shape of this fluid grid ({} x {} x {} cells); "
        "keep the grid of the run that wrote the state",
        state.source, name, slab.grid.cells[0], slab.grid.cells[1], slab.grid.cells[2]);
  }
  const int nx = slab.grid.cells[0], ny = slab.grid.cells[1];
  const double* from = array.doubles(name).data() + slab.grid.plane_cells() * slab.first;
  for (int k = 0; k < owned_planes(slab, d); ++k) {
    for (int j = 0; j < ny; ++j, from += nx) std::copy_n(from, nx, field.row(j, k));
  }
}

const std::array<std::string, 3> axis{"x", "y", "z"};

}  // namespace

std::map<std::string, state::Array> Flow::save() const {
  std::map<std::string, state::Array> arrays;
  const auto keep = [&](const std::string& name, const Field& field, int d) {
    std::vector<double> all = gather(slab_, field, d);
    if (slab_.rank == 0) arrays["fluid/" + name] = state::Array::of(std::move(all), shape_of(slab_, d));
  };
  for (int d = 0; d < 3; ++d) {
    keep("velocity_" + axis[d], velocity_[d], d);
    keep("rate_" + axis[d], rate_[d], d);
  }
  keep("pressure", pressure_, 3);
  if (krylov_ && cells_of_version_ >= 0) {
    Field start(slab_);
    krylov_->store_start(start);
    keep("pressure_start", start, 3);
  }
  const std::vector<double> carried = solids_.carried();
  if (slab_.rank == 0) {
    if (solids_.interpolated()) arrays["fluid/ghost_faces_carry_mm_per_s"] = state::Array::of(carried);
    arrays["fluid/previous_step_s"] = state::Array::scalar(previous_dt_);
    arrays["fluid/end_pressure_Pa"] =
        state::Array::of(std::vector<double>{end_pressure_[0], end_pressure_[1]});
  }
  return arrays;
}

void Flow::load(const state::State& state) {
  for (int d = 0; d < 3; ++d) {
    scatter(slab_, state, "fluid/velocity_" + axis[d], velocity_[d], d);
    scatter(slab_, state, "fluid/rate_" + axis[d], rate_[d], d);
  }
  scatter(slab_, state, "fluid/pressure", pressure_, 3);
  if (krylov_) {
    prepare_cells();
    Field start(slab_);
    scatter(slab_, state, "fluid/pressure_start", start, 3);
    krylov_->load_start(start);
  }
  previous_dt_ = state.array("fluid/previous_step_s").number("fluid/previous_step_s");
  const auto& ends = state.array("fluid/end_pressure_Pa").doubles("fluid/end_pressure_Pa");
  if (ends.size() != 2)
    throw InputError("{}: fluid/end_pressure_Pa has {} entries, expected 2", state.source, ends.size());
  std::copy_n(ends.begin(), 2, end_pressure_.begin());
  if (solids_.interpolated()) {
    const char* name = "fluid/ghost_faces_carry_mm_per_s";
    solids_.restore_carried(state.array(name).doubles(name));
  }
  fill_ghosts();
}

state::Image Flow::image() const {
  const Grid& grid = slab_.grid;
  Field centre(slab_);
  std::array<std::vector<double>, 3> component;
  for (int d = 0; d < 3; ++d) {
    const Field& u = velocity_[d];
    for (int k = 0; k < slab_.planes; ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          centre(i, j, k) = 0.5 * (u(i, j, k) + u(i + (d == 0), j + (d == 1), k + (d == 2)));
        }
      }
    }
    component[d] = gather(slab_, centre, 3);
  }
  const std::vector<double> pressure = gather(slab_, pressure_, 3);

  state::Image image;
  image.dimensions = {grid.cells[0], grid.cells[1], grid.cells[2]};
  image.origin = grid.position(3, 0, 0, 0);
  image.spacing = Vec3::Constant(grid.h);
  if (slab_.rank != 0) return image;
  const std::size_t cells = grid.all_cells();
  std::vector<float> velocity(3 * cells), millimetres(cells);
  for (std::size_t c = 0; c < cells; ++c) {
    for (int d = 0; d < 3; ++d) velocity[3 * c + d] = static_cast<float>(component[d][c]);
    millimetres[c] = static_cast<float>(pressure[c] / units::pa_per_mmHg);
  }
  std::vector<std::size_t> shape = shape_of(slab_, 3);
  image.point_data["pressure_mmHg"] = state::Array::of(std::move(millimetres), shape);
  shape.push_back(3);
  image.point_data["velocity_mm_per_s"] = state::Array::of(std::move(velocity), shape);
  return image;
}

}  // namespace valsalva::fluid
