#include "scene/scene.hpp"

namespace valsalva {

void declare_output(Schema& schema) {
  schema.table("output", "What is written on the way; nothing here changes what is computed");
  schema.real("output.checkpoint_s", 60, {0.01, 1e5}, "Wall time between two checkpoints of a stage");
  schema.reals(
      "output.view_times_s", {}, 0, {0, 1e9},
      "A scene without fluid keeps, beyond the last two, the state and views of the first row of its history "
      "at or after each of these times");
}

}  // namespace valsalva
