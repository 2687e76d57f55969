// The pressure equation lap phi = b on cell centres, plane by plane (a plane: nx ny doubles, x fastest).
#pragma once

#include <functional>
#include <limits>

namespace valsalva::fluid {

/// Local planes from <= k < to; those that are not there are left out.
struct Planes {
  int from = std::numeric_limits<int>::min(), to = std::numeric_limits<int>::max();
  bool has(int k) const { return k >= from && k < to; }
};

class PressureSolver {
 public:
  virtual ~PressureSolver() = default;
  /// k is the local plane. Planes are visited once each, in an order of the solver's choice.
  using Source = std::function<void(int k, double* plane)>;
  using Sink = std::function<void(int k, const double* plane)>;
  /// Collective. Where the mean of phi is free, the mean of b is dropped and that of phi is 0. within: b is
  /// zero in all other planes, and phi is not wanted there; they may still be visited.
  virtual void solve(const Source& b, const Sink& phi, Planes within = {}) = 0;
};

}  // namespace valsalva::fluid
