#include "structure/dead_load.hpp"

namespace valsalva::structure {

DeadLoadTerm::DeadLoadTerm(std::string name, Points force, Points moment,
                           std::function<double(double)> factor)
    : name_(std::move(name)),
      force_(std::move(force)),
      moment_(std::move(moment)),
      factor_(std::move(factor)) {}

double DeadLoadTerm::add_forces(const Configuration& now, Forces& out) const {
  VALSALVA_ASSERT(force_.size() <= out.force.size() && moment_.size() <= out.moment.size());
  const double s = factor_(now.time_s);
  for (std::size_t a = 0; a < force_.size(); ++a) out.force[a] += s * force_[a];
  for (std::size_t r = 0; r < moment_.size(); ++r) out.moment[r] += s * moment_[r];
  return 0;
}

Points weight_of(const System& system, const Body& body, const Vec3& acceleration) {
  Points force(system.nodes(), Vec3::Zero());
  for (int a = body.begin(); a < body.end(); ++a) force[a] = system.mass(a) * acceleration;
  return force;
}

}  // namespace valsalva::structure
