#include "turek_hron.hpp"

#include <algorithm>
#include <cmath>

#include "materials/st_venant_kirchhoff.hpp"
#include "solid_meshes.hpp"

namespace valsalva::turek {

namespace {

constexpr double height = 410, centre = 200, radius = 50, root = 250, end = 600, thickness = 20;
constexpr double kinematic_viscosity = 1e3, fluid_density = 1e-3;
constexpr double tie_rate = 500;  // forty times the motion

}  // namespace

BuiltBar build(const Bar& bar) {
  const structure::SolidMesh mesh =
      structure::solid_box(structure::Shape::hex27, {bar.across, 1, bar.along}, [&](const Vec3& u) {
        const double x = thickness * (u.x() - 0.5);
        const double foot = centre + std::sqrt(radius * radius - x * x);
        return Vec3(centre + x, bar.slab_mm * u.y(), foot + u.z() * (end - foot));
      });
  const double lambda = 2 * bar.shear_Pa * bar.poisson / (1 - 2 * bar.poisson);
  BuiltBar out;
  out.solid = std::make_shared<structure::Solid>(
      mesh,
      std::make_shared<materials::SolidLaw>(
          std::make_shared<materials::StVenantKirchhoff>(lambda, bar.shear_Pa), materials::Volumetric{},
          materials::Split::full),
      structure::Formulation::displacement);
  out.system = std::make_unique<structure::System>();
  out.body = out.system->add_body("bar", mesh.reference, out.solid->lumped_mass(bar.density));
  for (int a = 0; a < out.body.count; ++a) {
    const Vec3& x = mesh.reference[a];
    if (std::hypot(x.x() - centre, x.z() - centre) < radius * (1 + 1e-9)) {
      out.system->hold(a);
    } else {
      out.system->hold_along(a, Vec3::UnitY());
    }
    if ((x - Vec3(centre, 0, end)).norm() < 1e-6) out.tip = a;
  }
  out.terms.push_back(std::make_shared<structure::SolidTerm>(out.solid, out.body));
  return out;
}

Case::Case(const Channel& channel) : channel_(channel) {
  const double h = height / channel.cells_across;
  const int slab_cells = 3;
  channel_.bar.slab_mm = slab_cells * h;
  fluid::Boundaries boundaries;
  boundaries.side = {{{fluid::Side::wall, fluid::Side::wall},
                      {fluid::Side::periodic, fluid::Side::periodic},
                      {fluid::Side::inflow, fluid::Side::open}}};
  fluid::FlowParameters parameters;
  parameters.density = fluid_density;
  parameters.viscosity = fluid_density * kinematic_viscosity;
  parameters.wall = channel.wall;
  const int along = static_cast<int>(std::ceil(channel.length_mm / h));
  flow_ = std::make_unique<fluid::Flow>(
      MPI_COMM_SELF, fluid::Grid{{channel.cells_across, slab_cells, along}, Vec3::Zero(), h}, boundaries,
      parameters);
  // The faces that the bar's foot spreads to are held sharply: mirrored velocities of the interpolated wall
  // and the bar's forces there would feed each other.
  foot_ = flow_->solids().add_body("foot");
  const auto in_foot = [&](const Vec3& x) {
    const bool near = std::abs(x.x() - centre) < 0.5 * thickness + 2.5 * h && x.z() > centre;
    return near ? std::hypot(x.x() - centre, x.z() - centre) - radius : 1.0;
  };
  flow_->solids().mark_inside(foot_, in_foot, flow_->grid().low(), flow_->grid().high());
  flow_->solids().set_lumen(
      [](const Vec3& x) { return radius - std::hypot(x.x() - centre, x.z() - centre); });
  if (channel.ramp_s == 0)
    flow_->set_velocity([&](int d, const Vec3& x) { return d == 2 ? inflow(x) : 0.0; });

  BuiltBar bar = build(channel_.bar);
  tip_ = bar.tip;
  start_ = bar.system->state.x[tip_];
  coupling::ImmersedStructureSettings settings;
  settings.cells = coupling::cells_of(bar.solid->mesh());
  if (channel.sampled) settings.sampling_mm = 0.6 * h;
  if (channel_.bar.density > fluid_density) {
    coupling::add_excess_mass(*bar.system, bar.body, channel_.bar.density, fluid_density,
                              settings.excess_mass_g);
    settings.tie_rate_per_s = tie_rate;
  }
  auto immersed = std::make_unique<coupling::ImmersedStructure>(std::move(bar.system), bar.terms,
                                                                bar.solid->mesh().reference, settings);
  bar_ = immersed.get();
  coupling::ImmersedFlowSettings coupling;
  coupling.kernel = coupling::kernel_from(channel.kernel);
  coupling.limits.largest_s = 5e-3;
  system_ = std::make_unique<coupling::ImmersedFlow>(*flow_, std::move(immersed), coupling);
}

double Case::inflow(const Vec3& x) const {
  return 1.5 * channel_.mean_mm_per_s * 4 * x.x() * (height - x.x()) / (height * height);
}

Reading Case::step() {
  const coupling::ImmersedStep done = system_->step(1, [&](double dt) {
    const double at = time_s_ + dt;
    const double ramp = at < channel_.ramp_s ? 0.5 * (1 - std::cos(M_PI * at / channel_.ramp_s)) : 1;
    flow_->set_inflow(fluid::End::low, [&](const Vec3& x) { return ramp * inflow(x); });
  });
  time_s_ += done.dt_s;
  const Vec3 moved = bar_->x()[tip_] - start_;
  const double per_slab = 1e-6 / (channel_.bar.slab_mm * 1e-3);
  const Vec3 pull = per_slab * bar_->pull_on_holds();
  const Vec3 force =
      per_slab * (flow_->solids().force_on(fluid::Solids::wall) + flow_->solids().force_on(foot_)) + pull;
  return {time_s_,   moved.z(),      moved.x(), force.z(), force.x(), pull.z(), done.fluid.max_speed,
          done.dt_s, done.critical_s};
}

Oscillation oscillation(const std::vector<double>& time_s, const std::vector<double>& value, double from_s) {
  Oscillation out;
  const std::size_t begin = std::lower_bound(time_s.begin(), time_s.end(), from_s) - time_s.begin();
  if (begin + 2 >= value.size()) return out;
  const auto [low, high] = std::minmax_element(value.begin() + begin, value.end());
  out.mean = 0.5 * (*low + *high);
  out.amplitude = 0.5 * (*high - *low);
  std::vector<double> crossings;
  for (std::size_t i = begin + 1; i < value.size(); ++i)
    if (value[i - 1] < out.mean && value[i] >= out.mean)
      crossings.push_back(time_s[i - 1] + (time_s[i] - time_s[i - 1]) * (out.mean - value[i - 1]) /
                                              (value[i] - value[i - 1]));
  out.periods = crossings.empty() ? 0 : static_cast<int>(crossings.size()) - 1;
  if (out.periods > 0) out.frequency_Hz = out.periods / (crossings.back() - crossings.front());
  return out;
}

}  // namespace valsalva::turek
