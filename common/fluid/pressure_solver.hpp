// The pressure equation lap phi = b on cell centres, plane by plane (a plane: nx ny doubles, x fastest).
#pragma once

#include <functional>

namespace valsalva::fluid {

class PressureSolver {
 public:
  virtual ~PressureSolver() = default;
  /// k is the local plane. Planes are visited once each, in an order of the solver's choice.
  using Source = std::function<void(int k, double* plane)>;
  using Sink = std::function<void(int k, const double* plane)>;
  /// Collective. Where the mean of phi is free, the mean of b is dropped and that of phi is 0.
  virtual void solve(const Source& b, const Sink& phi) = 0;
};

}  // namespace valsalva::fluid
