#include "fluid/poisson_periodic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::fluid {

namespace {

template <class T>
T* allocate(std::size_t size) {
  T* data = static_cast<T*>(fftw_malloc(std::max<std::size_t>(size, 1) * sizeof(T)));
  if (!data) throw EnvironmentError("out of memory for {} modes of the pressure solver", size);
  return data;
}

fftw_complex* raw(std::complex<double>* modes) {
  return reinterpret_cast<fftw_complex*>(modes);
}

double squared_symbol(const std::function<double(double)>& symbol, int m, int n) {
  const double angle = 2 * std::numbers::pi * (2 * m > n ? m - n : m) / n;
  return std::pow(symbol(angle), 2);
}

}  // namespace

PeriodicPoisson::PeriodicPoisson(const Slab& slab, const std::function<double(double)>& symbol)
    : comm_(slab.comm),
      planes_(slab.planes),
      nx_(slab.grid.cells[0]),
      ny_(slab.grid.cells[1]),
      nz_(slab.grid.cells[2]) {
  const int nx = nx_, ny = ny_, half = nx / 2 + 1;
  modes_ = half * ny;
  for (int r = 0; r <= slab.ranks; ++r)
    mode_first_.push_back(static_cast<int>(static_cast<long>(modes_) * r / slab.ranks));
  first_ = mode_first_[slab.rank];
  own_ = mode_first_[slab.rank + 1] - first_;
  for (int r = 0; r < slab.ranks; ++r) {  // in doubles
    plane_counts_.push_back(2 * planes_ * (mode_first_[r + 1] - mode_first_[r]));
    plane_starts_.push_back(2 * planes_ * mode_first_[r]);
    line_counts_.push_back(2 * own_ * (slab.first_of(r + 1) - slab.first_of(r)));
    line_starts_.push_back(2 * own_ * slab.first_of(r));
  }
  cells_.reset(allocate<double>(slab.grid.plane_cells()));
  plane_.reset(allocate<std::complex<double>>(modes_));
  lines_.reset(allocate<std::complex<double>>(static_cast<std::size_t>(own_) * nz_));
  bundle_.resize(static_cast<std::size_t>(modes_) * planes_);
  plane_forward_.reset(fftw_plan_dft_r2c_2d(ny, nx, cells_.get(), raw(plane_.get()), FFTW_ESTIMATE));
  plane_backward_.reset(fftw_plan_dft_c2r_2d(ny, nx, raw(plane_.get()), cells_.get(), FFTW_ESTIMATE));
  fftw_complex* lines = raw(lines_.get());
  if (own_ > 0) {
    const auto plan = [&](int sign) {
      return fftw_plan_many_dft(1, &nz_, own_, lines, nullptr, own_, 1, lines, nullptr, own_, 1, sign,
                                FFTW_ESTIMATE);
    };
    line_forward_.reset(plan(FFTW_FORWARD));
    line_backward_.reset(plan(FFTW_BACKWARD));
  }
  factor_.resize(static_cast<std::size_t>(own_) * nz_);
  const double scale = -slab.grid.h * slab.grid.h / static_cast<double>(slab.grid.all_cells());
  for (int l = 0; l < nz_; ++l) {
    for (int m = 0; m < own_; ++m) {
      const int mode = first_ + m;
      const double sum = squared_symbol(symbol, mode % half, nx) + squared_symbol(symbol, mode / half, ny) +
                         squared_symbol(symbol, l, nz_);
      factor_[static_cast<std::size_t>(l) * own_ + m] = mode + l == 0 ? 0 : scale / sum;
    }
  }
}

void PeriodicPoisson::exchange(const std::complex<double>* from, const std::vector<int>& counts,
                               const std::vector<int>& starts, std::complex<double>* to,
                               const std::vector<int>& to_counts, const std::vector<int>& to_starts) const {
  MPI_Alltoallv(from, counts.data(), starts.data(), MPI_DOUBLE, to, to_counts.data(), to_starts.data(),
                MPI_DOUBLE, comm_);
}

void PeriodicPoisson::solve(const Source& b, Field& phi, Planes) {
  const CellRows cells(cells_.get(), nx_);
  const int ranks = static_cast<int>(mode_first_.size()) - 1;
  // A bundle: for each rank in turn, the modes that it owns, plane after plane.
  const auto part = [&](int r, int k) {
    return bundle_.data() + static_cast<std::size_t>(planes_) * mode_first_[r] +
           static_cast<std::size_t>(k) * (mode_first_[r + 1] - mode_first_[r]);
  };
  for (int k = 0; k < planes_; ++k) {
    b(k, cells);
    fftw_execute(plane_forward_.get());
    for (int r = 0; r < ranks; ++r)
      std::copy(plane_.get() + mode_first_[r], plane_.get() + mode_first_[r + 1], part(r, k));
  }
  exchange(bundle_.data(), plane_counts_, plane_starts_, lines_.get(), line_counts_, line_starts_);
  if (own_ > 0) {
    fftw_execute(line_forward_.get());
    for (std::size_t m = 0; m < factor_.size(); ++m) lines_.get()[m] *= factor_[m];
    fftw_execute(line_backward_.get());
  }
  exchange(lines_.get(), line_counts_, line_starts_, bundle_.data(), plane_counts_, plane_starts_);
  for (int k = 0; k < planes_; ++k) {
    for (int r = 0; r < ranks; ++r)
      std::copy_n(part(r, k), mode_first_[r + 1] - mode_first_[r], plane_.get() + mode_first_[r]);
    fftw_execute(plane_backward_.get());
    cells.copy_to(phi, k, nx_, ny_);
  }
}

}  // namespace valsalva::fluid
