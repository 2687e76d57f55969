// What is not fluid inside the box: the outside of the lumen, and bodies held (or moved) in the flow.
//
// A face is solid (sharp, 0 or 1) when its centre lies outside the level set, or within a body's radius of
// its triangles, segments or any distance function. Solid faces are held at the body's velocity by implicit
// penalisation with the time constant eta (Angot, Bruneau, Fabrie 1999):
//
//   u <- (u + dt/eta U) / (1 + dt/eta)
//
// First order at the wall. A face belongs to one body, the first that claims it; body 0 is the lumen's wall.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fluid/grid.hpp"
#include "geometry/grid_sdf.hpp"

namespace valsalva::fluid {

using Distance = std::function<double(const Vec3&)>;  ///< mm, negative inside the lumen (or inside a body)

struct RigidMotion {
  Vec3 velocity = Vec3::Zero();  ///< mm/s
  Vec3 rate = Vec3::Zero();      ///< rad/s, about `centre`
  Vec3 centre = Vec3::Zero();
  Vec3 at(const Vec3& x) const { return velocity + rate.cross(x - centre); }
};

class Solids {
 public:
  static constexpr int wall = 0;

  explicit Solids(const Slab& slab);

  /// Faces where `distance` is not negative become wall; cells likewise outside the lumen.
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
  void set_motion(int body, const RigidMotion& motion) { motion_[body] = motion; }

  bool any() const { return any_; }
  /// 0: fluid; otherwise 1 + number of the body. Same index as a Field of the slab; valid on ghosts too.
  const std::vector<std::uint8_t>& face_owner(int d) const { return owner_[d]; }
  /// 1 where the cell's centre is inside the lumen and in no body's radius; same index as a Field.
  const std::vector<std::uint8_t>& lumen_cell() const { return lumen_cell_; }
  /// Faces owned by this rank that belong to the body, all components.
  long faces(int body) const;

  /// Penalises plane k of component d and adds the momentum taken from the fluid (g mm/s) to each body.
  void penalise_plane(int d, int k, double ratio, Field& velocity);
  void start_step() { removed_.assign(removed_.size(), Vec3::Zero()); }
  /// Force of the fluid on the body over the last step, micronewton, summed over ranks (collective).
  Vec3 force_on(int body, double dt) const;
  void set_density(double density) { density_ = density; }

 private:
  template <class Inside>
  void mark(int body, const Vec3& low, const Vec3& high, const Inside& inside);
  const Slab& slab_;
  double density_ = 1e-3;
  bool any_ = false;
  std::vector<std::string> names_;
  std::vector<RigidMotion> motion_;
  std::vector<Vec3> removed_;
  std::array<std::vector<std::uint8_t>, 3> owner_;
  std::vector<std::uint8_t> lumen_cell_;
};

}  // namespace valsalva::fluid
