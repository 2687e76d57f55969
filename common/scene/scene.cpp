#include "scene/scene.hpp"

namespace valsalva {

void declare_all(Schema& schema) {
  declare_case(schema);
}

}  // namespace valsalva
