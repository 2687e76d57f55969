#include "place.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/mpi.hpp"

namespace valsalva::cycle {

namespace {

std::string text_of(const Vec3& x) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", x.x(), x.y(), x.z());
}

std::string of_fluid(const fluid::Flow& flow) {
  const fluid::Slab& slab = flow.slab();
  double largest = -1;
  Vec3 place = Vec3::Zero();
  for (int k = 0; k < slab.planes; ++k)
    for (int j = 0; j < slab.grid.cells[1]; ++j)
      for (int i = 0; i < slab.grid.cells[0]; ++i)
        for (int d = 0; d < 3; ++d) {
          const double u = flow.velocity()[d](i, j, k);
          const double speed = std::isfinite(u) ? std::abs(u) : std::numeric_limits<double>::infinity();
          if (speed <= largest) continue;
          largest = speed;
          place = slab.grid.position(d, i, j, k + slab.first);
        }
  struct {
    double value;
    int rank;
  } mine{largest, mpi::rank(slab.comm)}, worst;
  MPI_Allreduce(&mine, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, slab.comm);
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, worst.rank, slab.comm);
  if (std::isinf(worst.value)) return "the fluid's velocity is not finite at " + text_of(place);
  return fmt::format("the fluid is fastest at {}, {:.4g} mm/s", text_of(place), worst.value);
}

std::string of_leaflets(const coupling::ImmersedShell& shell) {
  const Points& x = shell.x();
  const Points& reference = shell.shell().mesh().reference;
  double largest = -1;
  int node = 0;
  for (const Triangle& t : shell.shell().mesh().triangles)
    for (int e = 0; e < 3; ++e) {
      const int a = t[e], b = t[(e + 1) % 3];
      const double ratio = (x[a] - x[b]).norm() / (reference[a] - reference[b]).norm();
      if (!std::isfinite(ratio)) return fmt::format("leaflet node {} is not at a finite place", a);
      if (ratio <= largest) continue;
      largest = ratio;
      node = a;
    }
  return fmt::format("the leaflets are stretched most at node {}, {}, {:.3g} times", node, text_of(x[node]),
                     largest);
}

}  // namespace

std::string worst_place(const fluid::Flow& flow, const coupling::ImmersedShell* shell) {
  const std::string fluid = of_fluid(flow);
  return shell ? fluid + ", " + of_leaflets(*shell) : fluid;
}

}  // namespace valsalva::cycle
