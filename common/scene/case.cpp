#include "scene/scene.hpp"

namespace valsalva {

void declare_case(Schema& schema) {
  schema.table("case", "What the case is called and at which level of the fidelity ladder it runs");
  schema.text("case.name", "", "Name of the run folder; the case file's own name when absent");
  schema.text("case.title", "", "One line for the report");
  schema.choice("case.fidelity", "standard", {"draft", "standard", "fine", "reference"},
                "Level of the fidelity ladder, unless --fidelity says otherwise");
}

}  // namespace valsalva
