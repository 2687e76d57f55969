// Openings of a vessel on planes that cut the box anywhere: known pressure or known flow.
//
// An opening is the part of a plane within `radius` of `centre`; its normal n points out of the fluid, and
// s = (x - centre) n. Cells whose centre has s <= -(h/2) max|n_d| are fluid; what lies between that and four
// cells beyond the plane is cut off from the fluid but for the faces between the two, the opening's faces.
// (A plane on grid faces has exactly these as its faces.)
//
// Known pressure p. Between the centre of the fluid cell and the plane the pressure is linear along n, so
// that across an opening's face, with the fluid cell on the side of the sign o = sign n_d,
//   dp/dx_d = o (p - p_cell) / (theta h),   theta = -s_cell / (h |n_d|) >= 1/2
// which is symmetric in the pressure equation (krylov_pressure.hpp) and of second order. What leaves does so
// with zero gradient of the velocity along n. What enters through a face comes from rest in a reservoir, as
// at open sides (boundary.hpp): with w = u n the mean over the faces of the fluid cell, and u_d the face's
// own,
//   p - rho max(w^2 where w < 0, u_d^2) / 2 in place of p,   velocity w n beyond the plane where w < 0,
//   viscosity as in the fluid
// so that an opening gives at most p Q. Towards zero tangential velocity: on an opening's face
//   du_d/dt = ... - (|u_d| + |u|) / h (u_d - (u n) n_d)
// Without it corners of the stairs that an oblique plane makes feed streams of their own (three times
// sqrt(2 p / rho) in single cells).
//
// Known flow Q: velocity along n with the given profile; its sum over the opening's faces is Q to round-off.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"
#include "fluid/momentum.hpp"
#include "fluid/pressure_solver.hpp"
#include "fluid/solids.hpp"

namespace valsalva::fluid {

struct OpeningPlane {
  std::string name;
  Vec3 centre = Vec3::Zero(), normal = Vec3::UnitZ();  ///< normal: unit, out of the fluid
  double radius = 1e300;                               ///< mm; must reach beyond the vessel's section
  std::function<double(const Vec3&)> profile;          ///< of known flow; none: known pressure
};

class Openings {
 public:
  Openings(const Slab& slab, double kinematic_viscosity);

  int add(const OpeningPlane& plane);
  int count() const { return static_cast<int>(planes_.size()); }
  const OpeningPlane& plane(int opening) const { return planes_[opening]; }
  bool known_flow(int opening) const { return static_cast<bool>(planes_[opening].profile); }

  void set_pressure(int opening, double pressure) { pressure_[opening] = pressure; }  ///< Pa
  void set_flow(int opening, double outwards) { flow_[opening] = outwards; }          ///< mm3/s
  double pressure(int opening) const { return pressure_[opening]; }
  const std::vector<double>& pressures() const { return pressure_; }

  /// Finds cells and faces as the solids stand, and takes what lies beyond out of the fluid. Collective; anew
  /// when solids change. InputError: no fluid in an opening, or fluid beside it.
  void build(Solids& solids);
  /// Takes the openings' faces out of the conductances between cells; known: d of krylov_pressure.hpp.
  void apply(FaceField& conductance, Field& known) const;
  /// What known pressures (of all openings, Pa) add to the plane k of h^-2 times the equation's right-hand
  /// side, where phi is the pressure itself.
  void add_known_pressure(int k, const std::vector<double>& known, const CellRows& b) const;
  /// Takes a face out of the fluid for good.
  void shut(Solids& solids, int d, int i, int j, int k) const { solids.claim(body_, d, i, j, k); }
  /// Shuts the faces of cells that are not solved for: corners that nothing else joins with the fluid.
  /// InputError for an opening that is left without faces.
  void keep_joined(const std::function<bool(int i, int j, int k)>& solves, Solids& solids);

  /// Before and after Momentum::advance: the openings' faces instead of what it made of them.
  void keep_rates(const FaceField& rate);
  void advance(const FaceField& velocity, const Advance& step, FaceField& rate, FaceField& next) const;
  /// Faces of known flow.
  void prescribe(FaceField& velocity) const;
  /// u -= factor dphi/dx_d h on the faces of known pressure, where phi is `known` (of all openings).
  void correct(double factor, const std::vector<double>& known, const Field& phi, FaceField& velocity) const;
  /// Velocity beyond the planes; ghost planes of neighbours must be valid.
  void extend(FaceField& velocity) const;

  /// mm3/s (collective).
  double outflow(int opening, const FaceField& velocity) const;
  /// Of its faces projected on the plane, mm2.
  double area(int opening) const { return area_[opening]; }
  /// The largest |u|+|v|+|w| that known flows prescribe, mm/s, on this rank.
  double largest_prescribed() const;
  /// The largest |u|+|v|+|w| in cells at openings, on this rank.
  double largest_speed(const FaceField& velocity) const;

 private:
  /// Faces (indices in a Field) whose mean is the velocity of a cell: the opening's own where there is one.
  struct CellFaces {
    std::array<std::array<std::ptrdiff_t, 2>, 3> of;
    Vec3 velocity(const FaceField& u) const {
      Vec3 v;
      for (int d = 0; d < 3; ++d) v[d] = 0.5 * (u[d].data()[of[d][0]] + u[d].data()[of[d][1]]);
      return v;
    }
  };
  struct Face {  // of this rank
    int opening, d;
    std::array<int, 3> of_face, of_cell;
    std::ptrdiff_t face, cell;
    double outward, inverse;  ///< o, and 1/theta
    double shape;             ///< of known flow: velocity at a flow of 1
    CellFaces near;
  };
  struct KnownCell {
    int i, j, k, opening;
    double conductance;
  };
  struct Beyond {  // a face beyond the plane, of this rank
    int opening, d;
    std::ptrdiff_t face, source;
    bool fluid;    ///< its source
    double shape;  ///< of known flow
    bool has_cell;
    CellFaces near;
  };
  void mark_cells();
  void find_faces(const FaceField& open);
  void close(Solids& solids) const;
  void find_beyond(const FaceField& open);
  CellFaces faces_of(int i, int j, int k, int opening, const FaceField& open) const;
  bool is_beyond(int i, int j, int k) const { return beyond_(i, j, k) > 0; }
  int opening_between(int d, int i, int j, int k, bool& high_is_beyond) const;
  double height(int opening, const Vec3& x) const {
    return (x - planes_[opening].centre).dot(planes_[opening].normal);
  }
  double margin(int opening) const;

  const Slab& slab_;
  double nu_;
  int body_ = -1;  ///< of the solids: what lies beyond
  std::vector<OpeningPlane> planes_;
  std::vector<double> pressure_, flow_, area_;
  std::vector<double> profile_flow_;  ///< of known flow: what its profile carries as it stands
  Field beyond_;                      ///< cells: 1 + opening beyond which they lie, 0: none
  std::vector<Face> faces_;
  std::vector<KnownCell> known_;
  std::vector<Beyond> behind_;
  std::vector<double> kept_rate_;
};

}  // namespace valsalva::fluid
