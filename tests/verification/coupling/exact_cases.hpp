// Problems of fluid and immersed structure with an exact solution, in thin periodic slabs (four cells in y).
#pragma once

#include <string>

namespace valsalva::exact {

/// A stretched sheet, flat but for a small cosine, in a box of fluid periodic in all directions: a damped
/// standing wave. Exact, for a massless sheet of tension T at small amplitude a (k = 2 pi/L; the tangential
/// velocity of the sheet vanishes by symmetry): the modes w_m of the velocity normal to the sheet, m = 2 pi
/// j/L, and the amplitude e obey
///   w_m' = -nu (k^2 + m^2) w_m - T k^4 e / (rho L (k^2 + m^2)),   e' = sum over m of w_m.
struct Wave {
  int cells = 32;  ///< over the wave length (16 mm)
  std::string kernel = "ib4";
  bool sampled = false;    ///< nodes one h apart and points h/2 apart; otherwise nodes h/2 apart
  bool kirchhoff = false;  ///< the sheet is a Kirchhoff-Love shell without bending stiffness worth mention
};
struct WaveResult {
  double error = 0;                       ///< largest over 1.2 periods, relative to a
  double period = 0, exact_period = 0;    ///< s, from the first two downward crossings of zero
  double damping = 0, exact_damping = 0;  ///< value at the first maximum after the start over a
  long steps = 0;
  double seconds_a_step = 0;
};
WaveResult wave(const Wave& wave);

/// A stiff disc (radius 4 mm) and the fluid around it turn as one inside a round container (8 mm) at rest,
/// which brakes them. Exact: the diffusion of the azimuthal velocity between disc and container with the
/// disc's inertia at its edge, on a fine radial grid.
struct Spin {
  int cells_a_radius = 8;  ///< of the disc
  double density_ratio = 1;
  std::string kernel = "ib4";
  bool sampled = true;
};
struct SpinResult {
  double error = 0;  ///< largest of the disc's rate over 0.15 s, relative to the initial rate
  double rate_at_end = 0, exact_at_end = 0;  ///< rad/s
  double largest_strain = 0;                 ///< of an edge
  double turned_rad = 0;
  long steps = 0;
};
SpinResult spin(const Spin& spin);

/// A closed round membrane (radius 6 mm), stretched by a tenth and so under pressure, in fluid at rest: it
/// has to keep the area it encloses, and its pressure is that of Laplace's law.
struct Membrane {
  double h = 1;
  double node_spacing = 0.5, sampling = 0;  ///< in h; sampling 0: coupling at the nodes
  std::string kernel = "ib4";
  long steps = 10000;
};
struct MembraneResult {
  double leak = 0;            ///< of the area, relative
  double pressure_ratio = 0;  ///< over Laplace's
  double largest_speed = 0;   ///< mm/s, of a node in the last step
  double time_s = 0, dt_s = 0, seconds_a_step = 0;
  std::size_t points = 0;
};
MembraneResult membrane(const Membrane& membrane);

}  // namespace valsalva::exact
