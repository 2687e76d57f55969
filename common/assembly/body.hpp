// One body of a scene: its mesh, its mechanics, its surface; built from a [[body]] entry and added to a
// System.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "assembly/mesh.hpp"
#include "core/case.hpp"
#include "structure/beam.hpp"
#include "structure/rigid_body.hpp"
#include "structure/shell.hpp"
#include "structure/solid.hpp"
#include "structure/solid_surface.hpp"

namespace valsalva::assembly {

enum class Kind { shell, solid, beams, rigid };

struct BuiltBody {
  std::string name;
  Kind kind = Kind::shell;
  BodyMesh mesh;
  std::shared_ptr<const structure::Shell> shell;
  std::shared_ptr<const structure::BeamNetwork> beams;
  std::shared_ptr<const structure::Solid> solid;
  double density = 0;
  double bending_Pa = 0, bending_poisson = 0;  ///< of a shell
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
  std::optional<structure::RigidProperties> free;  ///< of a rigid body that moves freely
  std::shared_ptr<structure::RigidBody> rigid;     ///< such a body, in the system
  std::vector<double> half_thickness;              ///< per node; zero on solids
  structure::Body at;                              ///< where it stands in the system

  /// Triangles that others may touch: the shell's, the rigid surface's, the solid's outer faces cut up.
  std::vector<Triangle> surface() const;
  /// Share of the reference surface (beams: length times width) per node.
  std::vector<double> surface_area() const;
  std::vector<double> mass() const;
  /// Border edges of a sheet, the lines of beams; none of a solid. Nodes of the mesh.
  std::vector<Edge> border() const;
  /// A force on the place of a node of the system, which is in this body.
  void add_point_force(int node, const Vec3& force, Points& out) const { out[node] += force; }
};

/// InputError that names the case file and the entry.
BuiltBody build_body(const Case& scene, const Case& body);

/// Adds the body's nodes to the system (a rigid body's are held) and returns its elasticity, none for a rigid
/// body. Sets `at`, `rigid` and the velocities.
std::shared_ptr<structure::ForceTerm> add_to_system(BuiltBody& body, structure::System& system);

}  // namespace valsalva::assembly
