#include "coupling/kernel.hpp"

#include "core/errors.hpp"

namespace valsalva::coupling {

Weights weights(Basis basis, double x) {
  Weights w;
  if (support(basis) == 3) {
    const double centre = std::floor(x + 0.5), r = x - centre;  // -1/2 <= r < 1/2
    w.start = static_cast<int>(centre) - 1;
    if (basis == Basis::bspline3) {
      w.value = {0.5 * (0.5 - r) * (0.5 - r), 0.75 - r * r, 0.5 * (0.5 + r) * (0.5 + r), 0};
    } else {
      const double middle = (1 + std::sqrt(1 - 3 * r * r)) / 3;
      w.value = {0.5 * (1 - middle - r), middle, 0.5 * (1 - middle + r), 0};
    }
    return w;
  }
  const double left = std::floor(x), r = x - left, s = 1 - r;  // 0 <= r < 1
  if (basis == Basis::linear) {
    w.start = static_cast<int>(left);
    w.value = {s, r, 0, 0};
    return w;
  }
  w.start = static_cast<int>(left) - 1;
  if (basis == Basis::bspline4) {
    w.value = {s * s * s / 6, (4 - 6 * r * r + 3 * r * r * r) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
               r * r * r / 6};
  } else {
    const double q = std::sqrt(1 + 4 * r * s);
    w.value = {(1 + 2 * s - q) / 8, (1 + 2 * s + q) / 8, (1 + 2 * r + q) / 8, (1 + 2 * r - q) / 8};
  }
  return w;
}

int support(Basis basis) {
  switch (basis) {
    case Basis::linear:
      return 2;
    case Basis::ib3:
    case Basis::bspline3:
      return 3;
    default:
      return 4;
  }
}

namespace {

struct Named {
  const char* name;
  Kernel kernel;
};
constexpr Named known[] = {
    {"linear", {Basis::linear, Basis::linear}},
    {"ib3", {Basis::ib3, Basis::ib3}},
    {"ib4", {Basis::ib4, Basis::ib4}},
    {"bspline3", {Basis::bspline3, Basis::bspline3}},
    {"bspline4", {Basis::bspline4, Basis::bspline4}},
    {"cbs32", {Basis::bspline3, Basis::linear}},
    {"cbs43", {Basis::bspline4, Basis::bspline3}},
};

}  // namespace

const std::vector<std::string>& kernel_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Named& entry : known) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

Kernel kernel_from(const std::string& name) {
  for (const Named& entry : known)
    if (name == entry.name) return entry.kernel;
  std::string list;
  for (const std::string& each : kernel_names()) list += (list.empty() ? "" : ", ") + each;
  throw InputError("coupling: unknown kernel '{}'; expected one of {}", name, list);
}

}  // namespace valsalva::coupling
