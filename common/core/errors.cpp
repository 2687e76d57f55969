#include "core/errors.hpp"

namespace valsalva {

void assertion_failed(const char* expression, const char* file, int line) {
  throw std::logic_error(
      fmt::format("internal error: '{}' does not hold at {}:{}; please report it with the case file",
                  expression, file, line));
}

}  // namespace valsalva
