#include "fluid/plane_transform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::fluid {

namespace {

double* buffer(std::ptrdiff_t size) {
  double* data = fftw_alloc_real(size);
  if (!data) throw EnvironmentError("out of memory for a plane of {} numbers of the pressure solver", size);
  std::fill_n(data, size, 0.0);
  return data;
}

// out(to(i), j) = in(j, from(i)) in blocks that stay in the nearest cache.
template <class To, class From>
void transpose(int rows, int columns, const double* in, std::ptrdiff_t in_stride, double* out,
               std::ptrdiff_t out_stride, const To& to, const From& from) {
  constexpr int block = 8;
  for (int i0 = 0; i0 < columns; i0 += block) {
    const int i1 = std::min(columns, i0 + block);
    for (int j0 = 0; j0 < rows; j0 += block) {
      const int j1 = std::min(rows, j0 + block);
      for (int i = i0; i < i1; ++i) {
        double* target = out + to(i) * out_stride;
        for (int j = j0; j < j1; ++j) target[j] = in[from(j) * in_stride + i];
      }
    }
  }
}

}  // namespace

PlaneTransform::Direction::Direction(int cells_along, int columns_across, bool periodic)
    : n(cells_along),
      columns((columns_across + 1) / 2 * 2),
      padded(columns > columns_across),
      row(n),
      cosine(n, 1.0),
      sine(n, 0.0) {
  // Whole cache lines, an odd number of them, so that rows do not compete for the same places of the cache.
  stride = ((columns + 7) / 8 | 1) * 8;
  for (int j = 0; j < n; ++j) row[j] = periodic ? j : j % 2 == 0 ? j / 2 : n - (j + 1) / 2;
  for (int k = 0; k < n && !periodic; ++k) {
    cosine[k] = std::cos(std::numbers::pi * k / (2.0 * n));
    sine[k] = std::sin(std::numbers::pi * k / (2.0 * n));
  }
  cells.reset(buffer(n * stride));
  spectrum.reset(buffer(n * stride));
  auto* a = reinterpret_cast<fftw_complex*>(cells.get());
  auto* b = reinterpret_cast<fftw_complex*>(spectrum.get());
  const int across = static_cast<int>(stride / 2);
  to_spectrum.reset(fftw_plan_many_dft(1, &n, columns / 2, a, &n, across, 1, b, &n, across, 1, FFTW_FORWARD,
                                       FFTW_ESTIMATE));
  to_cells.reset(fftw_plan_many_dft(1, &n, columns / 2, b, &n, across, 1, a, &n, across, 1, FFTW_BACKWARD,
                                    FFTW_ESTIMATE));
}

// The partner of the last of an odd number of columns.
void PlaneTransform::Direction::clear_padding() {
  if (!padded) return;
  for (int k = 0; k < n; ++k) cells.get()[k * stride + columns - 1] = 0;
}

// The columns a and b of Z = A + i B, A and B the spectra of real numbers: 2 A_k = Z_k + conj Z_(n-k),
// 2 i B_k = Z_k - conj Z_(n-k);  c_k - i c_(n-k) = (cos - i sin) 2 A_k.
void PlaneTransform::Direction::separate(const double* in, std::ptrdiff_t in_stride, double* out,
                                         std::ptrdiff_t out_stride) const {
  for (int i = 0; i < columns; ++i) out[i] = 2 * in[i];
  for (int k = 1; 2 * k <= n; ++k) {
    const int l = n - k;
    const double c = cosine[k], s = sine[k];
    const double* p = in + k * in_stride;
    const double* q = in + l * in_stride;
    double* a = out + k * out_stride;
    double* b = out + l * out_stride;
    if (k == l) {
      for (int i = 0; i < columns; ++i) a[i] = 2 * c * p[i];
      continue;
    }
#pragma omp simd
    for (int i = 0; i < columns; i += 2) {
      const double ar = p[i] + q[i], ai = p[i + 1] - q[i + 1];
      const double br = p[i + 1] + q[i + 1], bi = q[i] - p[i];
      a[i] = c * ar + s * ai;
      a[i + 1] = c * br + s * bi;
      b[i] = s * ar - c * ai;
      b[i + 1] = s * br - c * bi;
    }
  }
}

void PlaneTransform::Direction::unite(const double* in, std::ptrdiff_t in_stride, double* out,
                                      std::ptrdiff_t out_stride) const {
  std::copy_n(in, columns, out);
  for (int k = 1; 2 * k <= n; ++k) {
    const int l = n - k;
    const double c = cosine[k], s = sine[k];
    const double* a = in + k * in_stride;
    const double* b = in + l * in_stride;
    double* p = out + k * out_stride;
    double* q = out + l * out_stride;
    if (k == l) {
      for (int i = 0; i < columns; ++i) p[i] = a[i] / c;
      continue;
    }
#pragma omp simd
    for (int i = 0; i < columns; i += 2) {
      const double ar = c * a[i] + s * b[i], ai = s * a[i] - c * b[i];
      const double br = c * a[i + 1] + s * b[i + 1], bi = s * a[i + 1] - c * b[i + 1];
      p[i] = ar - bi;
      p[i + 1] = ai + br;
      q[i] = ar + bi;
      q[i + 1] = br - ai;
    }
  }
}

PlaneTransform::PlaneTransform(int nx, int ny, bool periodic_x, bool periodic_y)
    : y_(ny, nx, periodic_y), x_(nx, ny, periodic_x) {}

void PlaneTransform::forward(double* modes) {
  const int nx = x_.n, ny = y_.n;
  y_.clear_padding();
  fftw_execute(y_.to_spectrum.get());
  y_.separate(y_.spectrum.get(), y_.stride, y_.cells.get(), y_.stride);
  transpose(
      ny, nx, y_.cells.get(), y_.stride, x_.cells.get(), x_.stride, [&](int i) { return x_.row[i]; },
      [](int j) { return j; });
  x_.clear_padding();
  fftw_execute(x_.to_spectrum.get());
  x_.separate(x_.spectrum.get(), x_.stride, modes, mode_row());
}

void PlaneTransform::backward(const double* modes) {
  const int nx = x_.n, ny = y_.n;
  x_.unite(modes, mode_row(), x_.spectrum.get(), x_.stride);
  fftw_execute(x_.to_cells.get());
  transpose(
      nx, ny, x_.cells.get(), x_.stride, y_.cells.get(), y_.stride, [](int j) { return j; },
      [&](int i) { return x_.row[i]; });
  y_.clear_padding();
  y_.unite(y_.cells.get(), y_.stride, y_.spectrum.get(), y_.stride);
  fftw_execute(y_.to_cells.get());
}

}  // namespace valsalva::fluid
