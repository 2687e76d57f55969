// The plane transform against its definition, for even and odd sizes and all kinds of sides, also when used
// again.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <vector>

#include "fluid/plane_transform.hpp"

using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi;

struct Plane {
  int nx, ny;
  bool periodic_x, periodic_y;
};

void PrintTo(const Plane& p, std::ostream* out) {
  *out << p.nx << (p.periodic_x ? " periodic x " : " bounded x ") << p.ny
       << (p.periodic_y ? " periodic" : " bounded");
}

// Entry (k, j) of the one-dimensional transform.
double basis(int n, bool periodic, int k, int j) {
  if (!periodic) return 2 * std::cos(pi * k * (j + 0.5) / n);
  return 2 * k <= n ? 2 * std::cos(2 * pi * k * j / n) : 2 * std::sin(2 * pi * (n - k) * j / n);
}

class PlaneTransforms : public testing::TestWithParam<Plane> {};

TEST_P(PlaneTransforms, AgreeWithTheirDefinitionAndInvert) {
  const auto [nx, ny, periodic_x, periodic_y] = GetParam();
  PlaneTransform transform(nx, ny, periodic_x, periodic_y);
  const int mode_row = transform.mode_row();
  std::vector<double> modes(nx * mode_row), back(nx * ny);
  for (int use = 0; use < 5; ++use) {
    std::vector<double> cells(nx * ny);
    for (int c = 0; c < nx * ny; ++c) cells[c] = std::sin(1.7 * c * (use + 1)) + 0.3 * use;
    for (int j = 0; j < ny; ++j) std::copy_n(cells.data() + j * nx, nx, transform.cells().row(j));
    transform.forward(modes.data());
    for (int p = 0; p < nx; ++p) {
      for (int q = 0; q < ny; ++q) {
        double expected = 0;
        for (int j = 0; j < ny; ++j) {
          for (int i = 0; i < nx; ++i)
            expected += basis(nx, periodic_x, p, i) * basis(ny, periodic_y, q, j) * cells[j * nx + i];
        }
        // Sines may come with either sign: only eigenvectors matter.
        const bool sine = (periodic_x && 2 * p > nx) || (periodic_y && 2 * q > ny);
        const double found = modes[p * mode_row + q];
        EXPECT_NEAR(sine ? std::abs(found) : found, sine ? std::abs(expected) : expected, 1e-11 * nx * ny)
            << p << " " << q;
      }
    }
    transform.backward(modes.data());
    for (int j = 0; j < ny; ++j) std::copy_n(transform.cells().row(j), nx, back.data() + j * nx);
    for (int c = 0; c < nx * ny; ++c) EXPECT_NEAR(back[c] / (4.0 * nx * ny), cells[c], 1e-13 * (1 + use));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, PlaneTransforms,
                         testing::Values(Plane{8, 8, false, false}, Plane{7, 9, false, false},
                                         Plane{9, 8, false, true}, Plane{10, 7, true, false},
                                         Plane{7, 5, true, true}, Plane{12, 6, true, true},
                                         Plane{3, 31, false, false}));

}  // namespace
