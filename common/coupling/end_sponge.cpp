#include "coupling/end_sponge.hpp"

#include <algorithm>

namespace valsalva::coupling {

namespace {

constexpr double full_effect_mm_per_s = 20;  // W_0

}  // namespace

EndSponge::EndSponge(const fluid::Flow& flow, const SpongeParameters& parameters) : parameters_(parameters) {
  const fluid::Grid& grid = flow.grid();
  const int last = grid.cells[2];
  for (int n = 0; n * grid.h < parameters.depth_mm && n < last / 2; ++n) {
    const double share = 1 - n * grid.h / parameters.depth_mm;
    low_.push_back({n, n, share, flow.open_area(n)});
    high_.push_back({last - n, last - 1 - n, share, flow.open_area(last - n)});
  }
}

void EndSponge::add_force(const fluid::Flow& flow, fluid::FaceField& force) const {
  const auto mean = [&](const Plane& end) {
    return end.area > 0 ? flow.flow_through(end.plane) / end.area : 0.0;
  };
  if (low_.empty()) return;
  if (flow.boundaries().end(fluid::End::low) == fluid::Side::open)
    add_layer(flow, low_, mean(low_[0]), force);
  if (flow.boundaries().end(fluid::End::high) == fluid::Side::open)
    add_layer(flow, high_, -mean(high_[0]), force);
}

void EndSponge::add_layer(const fluid::Flow& flow, const std::vector<Plane>& layer, double entering,
                          fluid::FaceField& force) const {
  if (entering <= 0) return;
  const fluid::Slab& slab = flow.slab();
  const double effect = std::min(1.0, entering / full_effect_mm_per_s);
  for (const Plane& plane : layer) {
    const double mean = plane.area > 0 ? flow.flow_through(plane.plane) / plane.area : 0;
    const double rate = flow.parameters().density * parameters_.rate_per_s * effect * plane.share;
    for (int d = 0; d < 3; ++d) {
      const int k = (d == 2 ? plane.plane : plane.cells) - slab.first;
      if (k < 0 || k >= (d == 2 ? slab.w_planes() : slab.planes)) continue;
      const double target = d == 2 ? mean : 0;
      for (int j = 0; j < slab.grid.cells[1]; ++j) {
        const std::uint8_t* owner = flow.solids().owner_row(d, j, k);
        for (int i = 0; i < slab.grid.cells[0]; ++i)
          if (owner[i] == 0) force[d](i, j, k) -= rate * (flow.velocity()[d](i, j, k) - target);
      }
    }
  }
}

}  // namespace valsalva::coupling
