// The tests that fit and check a law: a thin sheet, C33 by plane stress, pulled in its plane along its two
// axes and sheared between grips. A stretch that is not prescribed is free: its direction bears no load
// (uniaxial test). The shear angle is prescribed, zero by default: a lone family of oblique fibres would
// shear a free strip, which grips prevent.
//   F = [[stretch1, shear stretch2], [0, stretch2]] in the plane.
#pragma once

#include <optional>

#include "materials/plane_law.hpp"

namespace valsalva::materials {

struct SheetLoad {
  std::optional<double> stretch1, stretch2;  ///< at least one
  double shear = 0;                          ///< tan of the shear angle
};

struct SheetState {
  double stretch1 = 1, stretch2 = 1, stretch3 = 1;
  double nominal1_Pa = 0, nominal2_Pa = 0;  ///< force per reference area (P11, P22)
  double energy_Pa = 0;
  double exponent = 0;
  Eigen::Matrix2d cauchy_Pa;
};

/// InputError when no stretch is prescribed or one is not positive; NumericalFailure when the free stretch
/// cannot be found.
SheetState sheet_test(const PlaneLaw& law, const PlaneFibres& fibres, const SheetLoad& load,
                      double factor = 1);

}  // namespace valsalva::materials
