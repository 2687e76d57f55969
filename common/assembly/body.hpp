// One body of a scene: its mesh, its mechanics, its surface; built from a [[body]] entry and added to a
// System.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "assembly/mesh.hpp"
#include "core/case.hpp"
#include "structure/beam.hpp"
#include "structure/kirchhoff_shell.hpp"
#include "structure/rigid_body.hpp"
#include "structure/shell.hpp"
#include "structure/solid.hpp"
#include "structure/solid_surface.hpp"

namespace valsalva::assembly {

enum class Kind { shell, solid, beams, rigid };

struct BuiltBody {
  std::string name;
  Kind kind = Kind::shell;
  BodyMesh mesh;                                  ///< its points: the stress-free shape
  Points imaged;                                  ///< the places that the mesh gave
  std::shared_ptr<const structure::Shell> shell;  ///< of hinges
  std::shared_ptr<const structure::KirchhoffShell> kirchhoff;
  std::optional<structure::ShellMesh> shell_mesh;  ///< from which the Kirchhoff shell will be made
  std::shared_ptr<const structure::SectionModel> section;
  std::function<std::vector<Mat3>(double)> clamps;  ///< how the clamps of a Kirchhoff shell have turned
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
  /// Where its nodes are.
  Points places(const structure::Configuration& now) const {
    return {now.x.begin() + at.begin(), now.x.begin() + at.end()};
  }
};

/// InputError that names the case file and the entry. reference: another stress-free shape than that of the
/// mesh (places of its nodes).
BuiltBody build_body(const Case& scene, const Case& body, const Points* reference = nullptr);

/// A Kirchhoff shell needs to know its supported edges; others are complete already.
void complete_shell(BuiltBody& body, const structure::EdgeConditions& edges);

/// Adds the body's nodes to the system (a rigid body's are held) and returns its elasticity, none for a rigid
/// body. Sets `at`, `rigid` and the velocities.
std::shared_ptr<structure::ForceTerm> add_to_system(BuiltBody& body, structure::System& system);

}  // namespace valsalva::assembly
