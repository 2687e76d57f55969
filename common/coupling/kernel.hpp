// Regularised delta functions in one dimension, in units of the grid spacing: the weight of the sample j for
// a node at x is phi(x - j), zero but for at most four neighbours. The three-dimensional kernel is the
// product.
//
// Every kernel fulfils  sum_j phi(x - j) = 1  and  sum_j (x - j) phi(x - j) = 0  for all x, and
//   linear    piecewise linear hat, support 2
//   ib3       Roma, Peskin and Berger 1999, support 3:   sum phi^2 = 1/2
//   ib4       Peskin 2002, support 4:   sum phi^2 = 3/8,  sum over even j = sum over odd j = 1/2
//   bspline3  quadratic B-spline, support 3:   sum (x - j)^2 phi = 1/4
//   bspline4  cubic B-spline, support 4:       sum (x - j)^2 phi = 1/3
// Composite B-splines (cbs32, cbs43) take for a velocity component the higher order along its own direction
// and the lower one across (3 and 2, 4 and 3): the interpolated velocity is divergence-free where the
// discrete one is (Gruninger et al. 2023, Local divergence-free immersed finite element-difference method).
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace valsalva::coupling {

enum class Basis { linear, ib3, ib4, bspline3, bspline4 };

/// The samples start, start + 1, ... start + 3 and their weights; unused ones are zero at the end.
struct Weights {
  int start = 0;
  std::array<double, 4> value{};
};

/// Of a node at x, samples at the integers.
Weights weights(Basis basis, double x);
/// Number of samples with a weight: 2, 3 or 4.
int support(Basis basis);

struct Kernel {
  Basis along;   ///< in the velocity component's own direction
  Basis across;  ///< in the other two
};

/// linear, ib3, ib4, bspline3, bspline4, cbs32, cbs43; InputError for any other name.
Kernel kernel_from(const std::string& name);
const std::vector<std::string>& kernel_names();

}  // namespace valsalva::coupling
