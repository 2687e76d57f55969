#include "fluid/poisson.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fluid/plane_transform.hpp"

namespace valsalva::fluid {

namespace {

// h^2 times minus the eigenvalues of the one-dimensional second difference, in the order of the transform.
std::vector<double> eigenvalues(int n, bool periodic) {
  std::vector<double> values(n);
  for (int m = 0; m < n; ++m) {
    const double angle =
        periodic ? std::numbers::pi * std::min(m, n - m) / n : std::numbers::pi * m / (2.0 * n);
    values[m] = 4 * std::pow(std::sin(angle), 2);
  }
  return values;
}

}  // namespace

struct Poisson::Impl {
  Impl(const Slab& slab, const Boundaries& boundaries);

  void factorise(const Boundaries& boundaries);
  void make_reduced_system();
  void forward(const Source& b, Planes within);
  void exchange_ends();
  void backward(Field& phi, Planes within);
  void solve_free_mean();

  double* plane(std::vector<double>& planes, int step) { return planes.data() + plane_of(step) * modes; }
  /// Local plane of a step of the sweep.
  std::size_t plane_of(int step) const { return reversed ? planes - 1 - step : step; }

  MPI_Comm comm;
  int rank, ranks, planes, nx, ny, nz;
  std::vector<int> firsts;
  double h;
  bool periodic_z, free_mean, reversed, has_start, has_end;
  PlaneTransform transform;
  std::size_t modes;            ///< of a plane, with those that only fill its rows
  std::vector<double> work;     ///< a plane of them
  std::vector<double> shift;    ///< eigenvalue of each mode
  std::vector<double> inverse;  ///< of the pivots, plane by plane
  std::vector<double> reduced;  ///< right-hand side, then forward-eliminated
  double scale = 1;             ///< -h^2 and the transforms' normalisation

  // Values at the ends: x_first = first + gain xs + ..., of this rank, one number a mode.
  std::vector<double> first_value, chain, start_value, end_value;
  std::vector<int> mode_first;          ///< division of the modes over the ranks
  std::vector<double> inverse_reduced;  ///< (2 P x 2 P) x own modes
  std::vector<double> sent, received;
  std::vector<double> mean_mode;  ///< right-hand side of the mode that is constant in x and y
};

Poisson::Impl::Impl(const Slab& slab, const Boundaries& boundaries)
    : comm(slab.comm),
      rank(slab.rank),
      ranks(slab.ranks),
      planes(slab.planes),
      nx(slab.grid.cells[0]),
      ny(slab.grid.cells[1]),
      nz(slab.grid.cells[2]),
      h(slab.grid.h),
      periodic_z(slab.periodic_z),
      transform(nx, ny, boundaries.periodic(0), boundaries.periodic(1)),
      modes(static_cast<std::size_t>(nx) * transform.mode_row()),
      work(modes) {
  for (int r = 0; r <= ranks; ++r) {
    firsts.push_back(slab.first_of(r));
    mode_first.push_back(static_cast<int>(modes * r / ranks));
  }
  // The last slab is swept from the far end, so that no chain of two slabs needs a second sweep.
  reversed = !periodic_z && ranks > 1 && slab.is_highest();
  has_start = periodic_z || (!slab.is_lowest() && !slab.is_highest());
  has_end = periodic_z || ranks > 1;
  free_mean = boundaries.end(End::low) != Side::open && boundaries.end(End::high) != Side::open;

  scale = -h * h / (4.0 * nx * ny);
  const std::vector<double> lx = eigenvalues(nx, boundaries.periodic(0)),
                            ly = eigenvalues(ny, boundaries.periodic(1));
  shift.assign(modes, 1.0);
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j)
      shift[static_cast<std::size_t>(i) * transform.mode_row() + j] = lx[i] + ly[j];
  }
  if (free_mean) shift[0] = 1;  // any regular value: this mode is solved apart
  mean_mode.resize(planes);
  factorise(boundaries);
  if (has_end) make_reduced_system();
}

void Poisson::Impl::factorise(const Boundaries& boundaries) {
  inverse.resize(modes * planes);
  reduced.resize(modes * planes);
  for (int step = 0; step < planes; ++step) {
    const int k = static_cast<int>(plane_of(step)) + firsts[rank];
    double end_term = 0;
    if (!periodic_z && k == 0) end_term += boundaries.end(End::low) == Side::open ? 1 : -1;
    if (!periodic_z && k == nz - 1) end_term += boundaries.end(End::high) == Side::open ? 1 : -1;
    double* now = plane(inverse, step);
    const double* before = step > 0 ? plane(inverse, step - 1) : nullptr;
    for (std::size_t m = 0; m < modes; ++m) {
      now[m] = 1 / (2 + shift[m] + end_term - (before ? before[m] : 0));
    }
  }
}

// With xs, xe the unknowns of the neighbours at the start and the end of this rank's sweep, elimination
// leaves
//   x_last = d + g xs + c xe,   x_first = a + b xs + g xe
// where g is the product of all inverse pivots, c the last of them, b = sum over steps of chain g.
void Poisson::Impl::make_reduced_system() {
  std::vector<double> coefficients(3 * modes);  // c, g, b
  const double* last = plane(inverse, planes - 1);
  for (std::size_t m = 0; m < modes; ++m) {
    double chain_product = 1, gain = 0;
    for (int step = 0; step < planes; ++step) {
      const double pivot = plane(inverse, step)[m];
      gain += chain_product * chain_product * pivot;
      chain_product *= pivot;
    }
    coefficients[m] = last[m];
    coefficients[modes + m] = has_start ? chain_product : 0;
    coefficients[2 * modes + m] = has_start ? gain : 0;
  }
  const int mine_from = mode_first[rank], mine = mode_first[rank + 1] - mine_from;
  std::vector<double> all(3 * modes * ranks);
  MPI_Allgather(coefficients.data(), static_cast<int>(3 * modes), MPI_DOUBLE, all.data(),
                static_cast<int>(3 * modes), MPI_DOUBLE, comm);

  const int size = 2 * ranks;  // unknowns: first and last of each rank
  const auto first_of = [](int r) { return 2 * r; };
  const auto last_of = [](int r) { return 2 * r + 1; };
  const auto is_reversed = [&](int r) { return !periodic_z && ranks > 1 && r == ranks - 1; };
  const auto start_of = [&](int r) { return last_of((r + ranks - 1) % ranks); };
  const auto end_of = [&](int r) {
    if (is_reversed(r)) return last_of(r - 1);
    const int next = (r + 1) % ranks;
    return is_reversed(next) ? last_of(next) : first_of(next);
  };
  inverse_reduced.resize(static_cast<std::size_t>(size) * size * mine);
  Eigen::MatrixXd matrix(size, size), answer(size, size);
  for (int m = 0; m < mine; ++m) {
    matrix.setIdentity();
    for (int r = 0; r < ranks; ++r) {
      const double* of_rank = all.data() + 3 * modes * r + mine_from + m;
      const double c = of_rank[0], g = of_rank[modes], b = of_rank[2 * modes];
      if (g != 0) matrix(last_of(r), start_of(r)) -= g;
      matrix(last_of(r), end_of(r)) -= c;
      if (g != 0) {
        matrix(first_of(r), start_of(r)) -= b;
        matrix(first_of(r), end_of(r)) -= g;
      }
    }
    const Eigen::MatrixXd inverted = matrix.inverse();
    for (int r = 0; r < ranks; ++r) {  // rows: what each rank needs, xs and xe
      answer.row(2 * r) = inverted.row(start_of(r));
      answer.row(2 * r + 1) = inverted.row(end_of(r));
    }
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        inverse_reduced[(static_cast<std::size_t>(row) * size + column) * mine + m] = answer(row, column);
      }
    }
  }
  first_value.resize(modes);
  chain.resize(modes);
  start_value.resize(modes);
  end_value.resize(modes);
  sent.resize(std::max(2 * modes, static_cast<std::size_t>(size) * mine));
  received.resize(sent.size());
}

void Poisson::Impl::forward(const Source& b, Planes within) {
  const bool needs_first = has_start;
  if (needs_first) {
    std::fill(first_value.begin(), first_value.end(), 0.0);
    std::fill(chain.begin(), chain.end(), 1.0);
  }
  double* in = work.data();
  for (int step = 0; step < planes; ++step) {
    const int k = static_cast<int>(plane_of(step));
    if (within.has(k)) {
      b(k, transform.cells());
      transform.forward(in);
    } else {
      std::fill_n(in, modes, 0.0);
    }
    mean_mode[k] = scale * in[0];
    const double* pivot = plane(inverse, step);
    double* now = plane(reduced, step);
    if (step == 0) {
      for (std::size_t m = 0; m < modes; ++m) now[m] = scale * in[m] * pivot[m];
    } else {
      const double* before = plane(reduced, step - 1);
#pragma omp simd
      for (std::size_t m = 0; m < modes; ++m) now[m] = (scale * in[m] + before[m]) * pivot[m];
    }
    if (needs_first) {
#pragma omp simd
      for (std::size_t m = 0; m < modes; ++m) {
        first_value[m] += chain[m] * now[m];
        chain[m] *= pivot[m];
      }
    }
  }
}

void Poisson::Impl::exchange_ends() {
  const int mine = mode_first[rank + 1] - mode_first[rank];
  std::vector<int> to_count(ranks), to_at(ranks), from_count(ranks, 2 * mine), from_at(ranks);
  const double* last = plane(reduced, planes - 1);
  int at = 0;
  for (int r = 0; r < ranks; ++r) {
    const int from = mode_first[r], count = mode_first[r + 1] - from;
    to_at[r] = at;
    to_count[r] = 2 * count;
    from_at[r] = 2 * mine * r;
    if (has_start) {
      std::copy_n(first_value.data() + from, count, sent.data() + at);
    } else {
      std::fill_n(sent.data() + at, count, 0.0);
    }
    std::copy_n(last + from, count, sent.data() + at + count);
    at += 2 * count;
  }
  MPI_Alltoallv(sent.data(), to_count.data(), to_at.data(), MPI_DOUBLE, received.data(), from_count.data(),
                from_at.data(), MPI_DOUBLE, comm);
  const int size = 2 * ranks;
  for (int row = 0; row < size; ++row) {
    double* out = sent.data() + static_cast<std::size_t>(row) * mine;
    std::fill_n(out, mine, 0.0);
    for (int column = 0; column < size; ++column) {
      const double* factor = inverse_reduced.data() + (static_cast<std::size_t>(row) * size + column) * mine;
      const double* in = received.data() + static_cast<std::size_t>(column) * mine;
      for (int m = 0; m < mine; ++m) out[m] += factor[m] * in[m];
    }
  }
  MPI_Alltoallv(sent.data(), from_count.data(), from_at.data(), MPI_DOUBLE, received.data(), to_count.data(),
                to_at.data(), MPI_DOUBLE, comm);
  for (int r = 0; r < ranks; ++r) {
    const int from = mode_first[r], count = mode_first[r + 1] - from;
    std::copy_n(received.data() + to_at[r], count, start_value.data() + from);
    std::copy_n(received.data() + to_at[r] + count, count, end_value.data() + from);
  }
}

void Poisson::Impl::backward(Field& phi, Planes within) {
  if (has_start) {
    for (int step = 0; step < planes; ++step) {
      const double* pivot = plane(inverse, step);
      double* now = plane(reduced, step);
#pragma omp simd
      for (std::size_t m = 0; m < modes; ++m) {
        start_value[m] *= pivot[m];
        now[m] += start_value[m];
      }
    }
  }
  double* x = work.data();
  if (has_end) {
    std::copy_n(end_value.data(), modes, x);
  } else {
    std::fill_n(x, modes, 0.0);
  }
  for (int step = planes - 1; step >= 0; --step) {
    const double* pivot = plane(inverse, step);
    const double* now = plane(reduced, step);
#pragma omp simd
    for (std::size_t m = 0; m < modes; ++m) x[m] = now[m] + pivot[m] * x[m];
    const int k = static_cast<int>(plane_of(step));
    if (!within.has(k)) continue;
    if (free_mean) std::swap(x[0], mean_mode[k]);
    transform.backward(x);
    if (free_mean) std::swap(x[0], mean_mode[k]);
    transform.cells().copy_to(phi, k, nx, ny);
  }
}

// The mode constant in x and y with Neumann or periodic ends: phi(k-1) - 2 phi(k) + phi(k+1) = -r(k), mean 0.
void Poisson::Impl::solve_free_mean() {
  std::vector<int> counts(ranks);
  for (int r = 0; r < ranks; ++r) counts[r] = firsts[r + 1] - firsts[r];
  std::vector<double> r(nz), phi(nz);
  MPI_Allgatherv(mean_mode.data(), planes, MPI_DOUBLE, r.data(), counts.data(), firsts.data(), MPI_DOUBLE,
                 comm);
  double mean = 0;
  for (double value : r) mean += value / nz;
  std::vector<double> slope(nz, 0.0);  // phi(k) - phi(k-1)
  for (int k = 1; k < nz; ++k) slope[k] = slope[k - 1] - (r[k - 1] - mean);
  if (periodic_z) {
    double average = 0;
    for (double value : slope) average += value / nz;
    for (double& value : slope) value -= average;
  }
  for (int k = 1; k < nz; ++k) phi[k] = phi[k - 1] + slope[k];
  double level = 0;
  for (double value : phi) level += value / nz;
  for (int k = 0; k < planes; ++k) mean_mode[k] = phi[firsts[rank] + k] - level;
}

Poisson::Poisson(const Slab& slab, const Boundaries& boundaries)
    : impl_(std::make_unique<Impl>(slab, boundaries)) {}
Poisson::~Poisson() = default;

void Poisson::solve(const Source& b, Field& phi, Planes within) {
  impl_->forward(b, within);
  if (impl_->has_end) impl_->exchange_ends();
  if (impl_->free_mean) impl_->solve_free_mean();
  impl_->backward(phi, within);
}

}  // namespace valsalva::fluid
