// What is not fluid inside the box: the outside of the lumen, and bodies held (or moved) in the flow.
//
// A face is solid (sharp, 0 or 1) when its centre lies outside the level set, or within a body's radius of
// its triangles, segments or any distance function. Solid faces are held at the body's velocity by implicit
// penalisation with the time constant eta (Angot, Bruneau, Fabrie 1999):
//
//   u <- (u + dt/eta U) / (1 + dt/eta)
//
// First order at the wall. With Wall::interpolated the first layer of solid faces beyond the lumen's wall
// does not stand still but carries the flow on smoothly through the wall (ghost faces; Mittal et al. 2008, J.
// Comput. Phys. 227): with s the distance of the face to the wall and n the direction inwards,
//
//   U_t = -(s / delta) u_t(x + (s + delta) n),   U_n = (s / delta)^2 u_n(x + (s + delta) n),
//
// along the wall and normal to it, u linear between its faces, delta the first of 1, 1.25, ... 2.25 h whose
// faces all lie inside the lumen; U = 0 where there is none (narrow gaps). Second order at the wall for the
// velocity; bodies stay sharp. What ghost faces carry is for the momentum of the faces beside them; volume is
// kept by the open faces alone (cut_cells). The normal part, because flow along the normal grows with the
// square of the distance: continued linearly it leaks through the wall. u is that of the last step's end:
// with the predicted velocity, in which the old pressure drives a leak on, leaks that answer themselves with
// less than -1/3 grow (docs/decisions/fluid.md).
//
// Force of the fluid on a body: the momentum that its faces take, per time. Of ghost faces without the change
// of what they carry themselves, which is no force (0.6 % of the lift of a shedding cylinder of 24 cells a
// diameter at Re 100).
//
// A face belongs to one body, the first that claims it; body 0 is the lumen's wall.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fluid/grid.hpp"
#include "fluid/pressure_solver.hpp"
#include "geometry/grid_sdf.hpp"

namespace valsalva::fluid {

using Distance = std::function<double(const Vec3&)>;  ///< mm, negative inside the lumen (or inside a body)

enum class Wall { staircase, interpolated };

/// InputError for an unknown name.
Wall wall_from(const std::string& name);

struct RigidMotion {
  Vec3 velocity = Vec3::Zero();  ///< mm/s
  Vec3 rate = Vec3::Zero();      ///< rad/s, about `centre`
  Vec3 centre = Vec3::Zero();
  Vec3 at(const Vec3& x) const { return velocity + rate.cross(x - centre); }
};

class Solids {
 public:
  static constexpr int wall = 0;

  Solids(const Slab& slab, double density, Wall form = Wall::staircase);

  /// Faces (and cells) whose centre has distance >= 0 become wall, unless a body holds them.
  void set_lumen(const Distance& distance);
  void set_lumen(const geometry::GridSdf& distance);

  /// A new body without faces; its number counts from 1. InputError after 254 bodies.
  int add_body(const std::string& name);
  int bodies() const { return static_cast<int>(names_.size()); }  ///< the wall included
  const std::string& name(int body) const { return names_[body]; }
  void clear_body(int body);
  /// Marks the free faces whose centre is within `radius` of the triangles, segments or points.
  void mark_triangles(int body, const Points& points, const std::vector<Triangle>& triangles, double radius);
  void mark_segments(int body, const Points& points, const std::vector<Edge>& segments, double radius);
  /// Marks the free faces with distance(x) < 0 inside the box low..high.
  void mark_inside(int body, const Distance& distance, const Vec3& low, const Vec3& high);
  /// Takes one face (d = 3: cell; owned, k local) for a body, whoever held it.
  void claim(int body, int d, int i, int j, int k) {
    owner_[d][index(i, j, k)] = static_cast<std::uint8_t>(1 + body);
    listed_ = false;
    ++version_;
  }
  /// Changes whenever faces change hands.
  long version() const { return version_; }
  /// Not for the wall, which is at rest.
  void set_motion(int body, const RigidMotion& motion);
  const RigidMotion& motion(int body) const { return motion_[body]; }

  /// 0: fluid; otherwise 1 + number of the body. d = 3: the cell's centre. Owned planes only, k local.
  std::uint8_t owner(int d, int i, int j, int k) const { return owner_[d][index(i, j, k)]; }
  const std::uint8_t* owner_row(int d, int j, int k) const { return owner_[d].data() + index(0, j, k); }
  /// Penalises all owned faces with ratio = dt/eta, and keeps the momentum taken from the fluid for force_on.
  /// last: the velocity at the end of the last step, with valid ghosts (read for interpolated walls only).
  void penalise(double dt, double eta, const FaceField& last, FaceField& velocity);
  /// Zero at all held faces of this rank in the given planes, ghost faces too.
  void still(FaceField& velocity, Planes within = {});
  /// Ghost faces of the interpolated wall on this rank, and those of them that found no place to interpolate
  /// at.
  long ghost_faces() const;
  long still_ghost_faces() const { return still_ghosts_; }
  /// A cell with faces that the interpolated wall closes.
  struct CutCell {
    int place;                                ///< j nx + i
    std::array<std::array<bool, 2>, 3> open;  ///< of each direction: low and high face
    /// Sum of the differences of u across the cell over its open faces; u[d]: at its low face, stride apart.
    double difference(const std::array<const double*, 3>& u,
                      const std::array<std::ptrdiff_t, 3>& stride) const {
      double sum = 0;
      for (int d = 0; d < 3; ++d) sum += (open[d][1] ? u[d][stride[d]] : 0) - (open[d][0] ? u[d][0] : 0);
      return sum;
    }
  };
  /// Those in the local plane k, by place; none with the staircase.
  const std::vector<CutCell>& cut_cells(int k) const { return cut_cells_[k]; }
  bool interpolated() const { return form_ == Wall::interpolated; }

  /// each(index in a Field, velocity of the body there) for the held faces of component d, in fixed order.
  /// Ghost faces take theirs from `velocity`, whose ghosts must be valid.
  template <class Each>
  void each_face(int d, const FaceField& velocity, const Each& each) const {
    for (const Ghost& ghost : ghosts_[d]) each(ghost.index, target(ghost, velocity));
    for (const Run& run : walls_[d]) {
      for (int i = 0; i < run.count; ++i) each(run.first + i, 0.0);
    }
    for (const Held& face : held_[d]) each(face.index, motion_[face.body].at(face.position)[d]);
  }
  /// Brings the lists of faces up to date: before each_face after marking.
  void prepare() {
    if (!listed_) list_faces();
  }
  /// In place of penalise, for a velocity that was penalised with eta elsewhere.
  /// before: what each_face was given.
  void record(double dt, double eta, const FaceField& before, const FaceField& velocity);
  /// Force of the fluid on the body over the last penalised step, micronewton (collective).
  Vec3 force_on(int body) const;
  /// Its moment about a point, micronewton mm (collective). Not for the wall.
  Vec3 moment_on(int body, const Vec3& about) const;
  /// Force (micronewton) and moment about a point (micronewton mm) that give this acceleration (mm/s2) to the
  /// fluid within the body, which moves with it: force_on and moment_on are less by it (collective).
  std::array<Vec3, 2> inertia(int body, const std::function<Vec3(const Vec3&)>& acceleration,
                              const Vec3& about);
  /// Takes the last penalised step back, as far as forces are concerned; and forgets all steps.
  void undo() { carried_ = carried_before_; }
  void forget() { carried_known_ = false; }
  /// For a restart (collective): what ghost faces of all ranks carry, mm/s summed over faces, after a 1; a 0
  /// before the first step.
  std::vector<double> carried() const;
  void restore_carried(const std::vector<double>& carried);

 private:
  struct Held {
    std::ptrdiff_t index;  ///< in a Field
    std::uint8_t body;
    Vec3 position;
  };
  struct Run {  // faces of the wall side by side in x
    std::ptrdiff_t first;
    int count;
  };
  struct Ghost {  // a face of the first layer beyond the wall, and where it interpolates
    std::ptrdiff_t index;
    std::array<std::ptrdiff_t, 3> corner;         ///< of each component
    std::array<std::array<double, 8>, 3> weight;  ///< of its faces from `corner` on, x fastest
  };
  double target(const Ghost& ghost, const FaceField& velocity) const {
    double sum = 0;
    for (int e = 0; e < 3; ++e) {
      const double* u = velocity[e].data().data() + ghost.corner[e];
      for (int c = 0; c < 8; ++c)
        sum += ghost.weight[e][c] * u[(c & 1) + (c >> 1 & 1) * slab_.stride_y + (c >> 2) * slab_.stride_z];
    }
    return sum;
  }
  void find_ghosts(const Distance& distance);
  void find_cut_cells(const Distance& distance);
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * slab_.grid.cells[1] + j) * slab_.grid.cells[0] + i;
  }
  template <class Inside>
  void mark(int body, const Vec3& low, const Vec3& high, const Inside& inside);
  void check_body(int body) const;
  void list_faces();
  void count_carried(double dt, const Vec3& now);

  const Slab& slab_;
  double density_;
  Wall form_;
  bool listed_ = true;
  long version_ = 0;
  long still_ghosts_ = 0;
  std::vector<std::string> names_;
  std::vector<RigidMotion> motion_;
  std::vector<Vec3> force_;                                      ///< of this rank
  std::vector<Vec3> moment_;                                     ///< of this rank, about the origin
  Vec3 carried_ = Vec3::Zero(), carried_before_ = Vec3::Zero();  ///< by ghost faces of this rank
  bool carried_known_ = false;
  std::array<std::vector<std::uint8_t>, 4> owner_;
  std::array<std::vector<Run>, 3> walls_;  ///< without ghost faces
  std::array<std::vector<Ghost>, 3> ghosts_;
  std::vector<std::vector<CutCell>> cut_cells_;  ///< of each local plane
  std::array<std::vector<Held>, 3> held_;        ///< faces of bodies other than the wall
};

}  // namespace valsalva::fluid
