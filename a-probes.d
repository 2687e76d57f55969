probes.o: common/assembly/probes.cpp \
 /tmp/c_shell/common/assembly/probes.hpp \
 /tmp/c_shell/common/assembly/scene.hpp \
 /tmp/c_shell/common/assembly/body.hpp \
 /tmp/c_shell/common/assembly/mesh.hpp /tmp/c_shell/common/core/types.hpp \
 /tmp/c_shell/common/structure/element_shapes.hpp \
 /tmp/c_shell/common/core/case.hpp /tmp/c_shell/common/core/schema.hpp \
 /tmp/c_shell/common/core/fidelity.hpp \
 /tmp/c_shell/common/structure/beam.hpp \
 /tmp/c_shell/common/structure/beam_fibres.hpp \
 /tmp/c_shell/common/materials/superelastic.hpp \
 /tmp/c_shell/common/structure/force_term.hpp \
 /tmp/c_shell/common/core/errors.hpp \
 /tmp/c_shell/common/structure/block_matrix.hpp \
 /tmp/c_shell/common/structure/system.hpp \
 /tmp/c_shell/common/structure/kirchhoff_shell.hpp \
 /tmp/c_shell/common/structure/kirchhoff_edges.hpp \
 /tmp/c_shell/common/structure/kirchhoff_section.hpp \
 /tmp/c_shell/common/materials/plane_law.hpp \
 /tmp/c_shell/common/structure/shell.hpp \
 /tmp/c_shell/common/materials/plane_stress.hpp \
 /tmp/c_shell/common/materials/elastic_law.hpp \
 /tmp/c_shell/common/materials/invariant_law.hpp \
 /tmp/c_shell/common/structure/rigid_body.hpp \
 /tmp/c_shell/common/structure/solid.hpp \
 /tmp/c_shell/common/materials/solid_law.hpp \
 /tmp/c_shell/common/materials/volumetric.hpp \
 /tmp/c_shell/common/structure/solid_surface.hpp \
 /tmp/c_shell/common/assembly/rigid_surface.hpp \
 /tmp/c_shell/common/contact/surface_nodes.hpp \
 /tmp/c_shell/common/geometry/grid_sdf.hpp \
 /tmp/c_shell/common/assembly/supports.hpp \
 /tmp/c_shell/common/assembly/time_table.hpp \
 /tmp/c_shell/common/solve/equations.hpp \
 /tmp/c_shell/common/solve/linear_solver.hpp \
 /tmp/c_shell/common/assembly/volume_load.hpp \
 /tmp/c_shell/common/contact/body_contact.hpp \
 /tmp/c_shell/common/contact/body_friction.hpp \
 /tmp/c_shell/common/contact/candidates.hpp \
 /tmp/c_shell/common/contact/broad_phase.hpp \
 /tmp/c_shell/common/contact/collision_mesh.hpp \
 /tmp/c_shell/common/contact/continuous.hpp \
 /tmp/c_shell/common/contact/distance.hpp \
 /tmp/c_shell/common/contact/pressure_law.hpp \
 /tmp/c_shell/common/core/units.hpp
