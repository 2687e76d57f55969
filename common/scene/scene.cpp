#include "scene/scene.hpp"

namespace valsalva {

void declare_all(Schema& schema) {
  declare_case(schema);
  declare_anatomy(schema);
  declare_phantom(schema);
  declare_mesh(schema);
  declare_native(schema);
  declare_device(schema);
  declare_contact(schema);
  declare_crimp(schema);
  declare_deploy(schema);
  declare_report(schema);
  declare_output(schema);
  declare_fluid(schema);
  declare_circulation(schema);
  declare_cycle(schema);
  declare_body(schema);
  declare_nodes(schema);
  declare_support(schema);
  declare_load(schema);
  declare_tie(schema);
  declare_contact_pair(schema);
  declare_dynamics(schema);
  declare_probe(schema);
  declare_coupling(schema);
  declare_boundary(schema);
  declare_obstacle(schema);
  declare_opening(schema);
  declare_flow_probe(schema);
  declare_test_section(schema);
}

}  // namespace valsalva
