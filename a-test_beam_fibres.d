test_beam_fibres.o: tests/unit/structure/test_beam_fibres.cpp \
 tests/unit/structure/beam_networks.hpp \
 /tmp/c_shell/common/structure/beam.hpp \
 /tmp/c_shell/common/structure/beam_fibres.hpp \
 /tmp/c_shell/common/materials/superelastic.hpp \
 /tmp/c_shell/common/structure/force_term.hpp \
 /tmp/c_shell/common/core/errors.hpp \
 /tmp/c_shell/common/structure/block_matrix.hpp \
 /tmp/c_shell/common/core/types.hpp \
 /tmp/c_shell/common/structure/system.hpp tests/unit/structure/meshes.hpp \
 /tmp/c_shell/common/structure/shell.hpp \
 /tmp/c_shell/common/materials/plane_stress.hpp \
 /tmp/c_shell/common/materials/elastic_law.hpp \
 /tmp/c_shell/common/materials/plane_law.hpp \
 /tmp/c_shell/common/materials/invariant_law.hpp \
 /tmp/c_shell/common/structure/integrator.hpp \
 /tmp/c_shell/common/structure/rigid_body.hpp
