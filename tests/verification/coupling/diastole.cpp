// What a step limited by flow would cost in diastole: a valve held closed, the explicit limit, and conjugate
// gradients on the linearised implicit step (I + dt^2 M K) U = b with the real spreading and interpolation
// M = (1/rho) J S and the present tangent K.
#include <cstdio>
#include <ctime>

#include "studies.hpp"
#include "valve_rig.hpp"

namespace valsalva {

namespace {

double processor_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double dot(const Points& a, const Points& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

/// y <- y + factor x
void add(Points& y, double factor, const Points& x) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * x[i];
}

// Iterations until the residual has fallen to the share, in the inner product with K, in which the operator
// is self-adjoint; one product with K and one with M each.
int iterations(const coupling::Operator& stiffness, const coupling::Operator& mobility, double dt,
               const Points& b, double share) {
  Points r = b, kr(b.size()), p, kp, ap(b.size()), kap(b.size());
  stiffness(r, kr);
  p = r;
  kp = kr;
  double square = dot(r, kr);
  const double wanted = share * share * square;
  int count = 0;
  for (; count < 1000 && square > wanted; ++count) {
    mobility(kp, ap);
    for (std::size_t i = 0; i < p.size(); ++i) ap[i] = p[i] + dt * dt * ap[i];
    stiffness(ap, kap);
    const double step = square / dot(kp, ap);
    add(r, -step, ap);
    add(kr, -step, kap);
    const double next = dot(r, kr);
    for (std::size_t i = 0; i < p.size(); ++i) {
      p[i] = r[i] + next / square * p[i];
      kp[i] = kr[i] + next / square * kp[i];
    }
    square = next;
  }
  return count;
}

}  // namespace

int study_diastole(double h, double end_s) {
  test::ValveRig rig(h);
  coupling::ImmersedStep last;
  double speed = 0;
  long steps = 0;
  double begin = processor_s();
  double explicit_s = 0;
  rig.run_to(end_s, [&](const coupling::ImmersedStep& step) {
    last = step;
    ++steps;
    if (rig.time_s > end_s - 2e-3) speed = std::max(speed, step.fluid.max_speed);
    if (steps % 100 == 0) {
      explicit_s = (processor_s() - begin) / 100;
      begin = processor_s();
    }
  });
  coupling::ImmersedShell& shell = *rig.system->shell();
  coupling::Transfer transfer(rig.flow->slab(), coupling::kernel_from("ib4"));
  transfer.locate(shell.coupling_points());
  shell.update_tangent();
  fluid::FaceField scratch(rig.flow->slab());
  double stiffness_s = 0, mobility_s = 0;
  long products = 0;
  const coupling::Operator stiffness = [&](const Points& y, Points& f) {
    const double start = processor_s();
    shell.tangent_product(y, f);
    stiffness_s += processor_s() - start;
    ++products;
  };
  const coupling::Operator mobility = [&](const Points& f, Points& v) {
    const double start = processor_s();
    scratch.fill(0);
    transfer.spread(f, scratch);
    transfer.interpolate(scratch, v);
    for (Vec3& each : v) each *= 1 / rig.flow->parameters().density;
    mobility_s += processor_s() - start;
  };
  Points force, b;
  shell.forces(force);
  mobility(force, b);
  const double explicit_step = coupling::StepLimits{}.safety * last.critical_s;
  const double flow_step = coupling::StepLimits{}.cfl * h / speed;
  std::printf("h %g mm, closed at %g ms: explicit step %.3g s, CFL step %.3g s, %zu nodes, %.3g ms a step\n",
              h, 1e3 * rig.time_s, explicit_step, flow_step, shell.x().size(), 1e3 * explicit_s);
  for (double ratio : {2.0, 4.0, 8.0, 16.0})
    for (double share : {0.1, 0.01, 0.001}) {
      const int count = iterations(stiffness, mobility, ratio * explicit_step, b, share);
      const double product = stiffness_s / products + mobility_s / products;
      std::printf(
          "step %4.0f times longer, residual %g: %d iterations, of %.3g + %.3g ms: costs %.2f explicit "
          "steps for one linear solve\n",
          ratio, share, count, 1e3 * stiffness_s / products, 1e3 * mobility_s / products,
          1 + count * product / explicit_s);
    }
  return 0;
}

}  // namespace valsalva
