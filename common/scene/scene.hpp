// The declarations of every case-file table, one source file a table. All stages know all tables, so that one
// misspelt key anywhere is an error everywhere.
#pragma once

#include "core/schema.hpp"

namespace valsalva {

void declare_all(Schema& schema);

void declare_case(Schema& schema);
void declare_anatomy(Schema& schema);
void declare_phantom(Schema& schema);
void declare_mesh(Schema& schema);
void declare_native(Schema& schema);
void declare_device(Schema& schema);
void declare_contact(Schema& schema);
void declare_crimp(Schema& schema);
void declare_deploy(Schema& schema);
void declare_report(Schema& schema);
void declare_output(Schema& schema);
void declare_fluid(Schema& schema);
void declare_circulation(Schema& schema);
void declare_cycle(Schema& schema);
void declare_body(Schema& schema);
void declare_nodes(Schema& schema);
void declare_support(Schema& schema);
void declare_load(Schema& schema);
void declare_tie(Schema& schema);
void declare_contact_pair(Schema& schema);
void declare_dynamics(Schema& schema);
void declare_probe(Schema& schema);
void declare_coupling(Schema& schema);
void declare_boundary(Schema& schema);
void declare_obstacle(Schema& schema);
void declare_opening(Schema& schema);
void declare_flow_probe(Schema& schema);
void declare_test_section(Schema& schema);

}  // namespace valsalva
