#include "scene/scene.hpp"

namespace valsalva {

void declare_output(Schema& schema) {
  schema.table("output", "What is written on the way; nothing here changes what is computed");
  schema.real("output.checkpoint_s", 60, {0.01, 1e5}, "Wall time between two checkpoints of a stage");
}

}  // namespace valsalva
