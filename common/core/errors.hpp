// Three kinds of failure that a user meets, kept apart, and the internal assertion.
//
//   InputError         the user's input is wrong: what was found, what is expected, what to do   (exit 2)
//   NumericalFailure   the computation cannot go on: where; the last good state is kept           (exit 3)
//   EnvironmentError   the machine refused: disk, permissions, memory, a missing program          (exit 4)
//   Interrupted        SIGINT or SIGTERM was received and a checkpoint written                    (exit 130)
//   VALSALVA_ASSERT    a bug of ours; always on, names the expression and the place
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace valsalva {

enum class ExitCode { ok = 0, input = 2, numerical = 3, environment = 4, interrupted = 130 };

class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

template <ExitCode kind>
class ErrorOf : public Error {
 public:
  explicit ErrorOf(const std::string& message) : Error(kind, message) {}
  template <class... Args>
  requires(sizeof...(Args) > 0) explicit ErrorOf(fmt::format_string<Args...> format, Args&&... args)
      : Error(kind, fmt::format(format, std::forward<Args>(args)...)) {}
};

using InputError = ErrorOf<ExitCode::input>;
using NumericalFailure = ErrorOf<ExitCode::numerical>;
using EnvironmentError = ErrorOf<ExitCode::environment>;
using Interrupted = ErrorOf<ExitCode::interrupted>;

[[noreturn]] void assertion_failed(const char* expression, const char* file, int line);

}  // namespace valsalva

#define VALSALVA_ASSERT(expression) \
  ((expression) ? void(0) : ::valsalva::assertion_failed(#expression, __FILE__, __LINE__))
