#include "profile.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::stent {

Profile::Profile(std::vector<double> heights_mm, std::vector<double> radii_mm, const std::string& what)
    : z_(std::move(heights_mm)), r_(std::move(radii_mm)), slope_(z_.size(), 0.0) {
  if (z_.empty() || z_.size() != r_.size())
    throw InputError("{}: {} heights and {} radii; expected one radius a height, at least one", what,
                     z_.size(), r_.size());
  for (std::size_t i = 0; i < z_.size(); ++i) {
    if (!std::isfinite(z_[i]) || !std::isfinite(r_[i]) || r_[i] <= 0)
      throw InputError("{}: radius {} mm at height {} mm; expected finite heights and positive radii", what,
                       r_[i], z_[i]);
    if (i > 0 && z_[i] <= z_[i - 1])
      throw InputError("{}: height {} mm follows {} mm; expected ascending heights", what, z_[i], z_[i - 1]);
  }
  for (std::size_t i = 1; i + 1 < z_.size(); ++i) {
    const double left = (r_[i] - r_[i - 1]) / (z_[i] - z_[i - 1]);
    const double right = (r_[i + 1] - r_[i]) / (z_[i + 1] - z_[i]);
    slope_[i] = left * right > 0 ? 2 * left * right / (left + right) : 0.0;
  }
  if (z_.size() > 1) {
    slope_.front() = (r_[1] - r_[0]) / (z_[1] - z_[0]);
    slope_.back() = (r_.back() - r_[r_.size() - 2]) / (z_.back() - z_[z_.size() - 2]);
  }
}

std::size_t Profile::interval(double z) const {
  const auto above = std::upper_bound(z_.begin() + 1, z_.end() - 1, z);
  return static_cast<std::size_t>(above - z_.begin()) - 1;
}

double Profile::radius(double z) const {
  if (z <= z_.front()) return r_.front();
  if (z >= z_.back()) return r_.back();
  const std::size_t i = interval(z);
  const double h = z_[i + 1] - z_[i], t = (z - z_[i]) / h;
  return (1 + 2 * t) * (1 - t) * (1 - t) * r_[i] + t * (1 - t) * (1 - t) * h * slope_[i] +
         t * t * (3 - 2 * t) * r_[i + 1] + t * t * (t - 1) * h * slope_[i + 1];
}

double Profile::slope(double z) const {
  if (z < z_.front() || z > z_.back() || z_.size() == 1) return 0;
  const std::size_t i = interval(z);
  const double h = z_[i + 1] - z_[i], t = (z - z_[i]) / h;
  return 6 * t * (1 - t) * (r_[i + 1] - r_[i]) / h + (1 - t) * (1 - 3 * t) * slope_[i] +
         t * (3 * t - 2) * slope_[i + 1];
}

Profile Profile::offset(double inwards_mm, const std::string& what) const {
  std::vector<double> radii = r_;
  for (double& r : radii) r -= inwards_mm;
  return Profile(z_, std::move(radii), what);
}

}  // namespace valsalva::stent
