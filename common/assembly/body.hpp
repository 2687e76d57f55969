// One body of a scene: its mesh, its mechanics, its surface; built from a [[body]] entry and added to a
// System.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "assembly/mesh.hpp"
#include "core/case.hpp"
#include "structure/beam.hpp"
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
  Vec3 velocity = Vec3::Zero();
  std::vector<double> half_thickness;  ///< per node; zero on solids
  structure::Body at;                  ///< where it stands in the system

  /// Triangles that others may touch: the shell's, the rigid surface's, the solid's outer faces cut up.
  std::vector<Triangle> surface() const;
  /// Share of the reference surface (beams: length times width) per node.
  std::vector<double> surface_area() const;
  std::vector<double> mass() const;
};

/// InputError that names the case file and the entry.
BuiltBody build_body(const Case& scene, const Case& body);

/// Adds the body's nodes to the system (a rigid body's are held) and returns its elasticity, none for a rigid
/// body. Sets `at`.
std::shared_ptr<structure::ForceTerm> add_to_system(BuiltBody& body, structure::System& system);

}  // namespace valsalva::assembly
