// Internal units are mm, g, s. Hence pressure in Pa (1 g/(mm s2) = 1 Pa), viscosity in Pa s (g/(mm s)),
// force in micronewton (g mm/s2), energy in nanojoule (g mm2/s2). This is the one place of conversions.
#pragma once

namespace valsalva::units {

inline constexpr double pa_per_mmHg = 133.322387415;
inline constexpr double pa_per_kPa = 1e3;
inline constexpr double pa_per_MPa = 1e6;
inline constexpr double pa_per_GPa = 1e9;
inline constexpr double pa_per_dyn_cm2 = 0.1;
inline constexpr double mm3_per_mL = 1e3;
inline constexpr double uN_per_N = 1e6;         ///< micronewton in one newton
inline constexpr double mm_per_Fr = 1.0 / 3.0;  ///< the French catheter scale
inline constexpr double mm2_per_cm2 = 100.0;
inline constexpr double s_per_min = 60.0;

/// Flow resistance: 1 mmHg s/mL in Pa s/mm3.
inline constexpr double resistance_per_mmHg_s_per_mL = pa_per_mmHg / mm3_per_mL;
/// Compliance: 1 mL/mmHg in mm3/Pa.
inline constexpr double compliance_per_mL_per_mmHg = mm3_per_mL / pa_per_mmHg;
/// Elastance: 1 mmHg/mL in Pa/mm3.
inline constexpr double elastance_per_mmHg_per_mL = pa_per_mmHg / mm3_per_mL;

}  // namespace valsalva::units
