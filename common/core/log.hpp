// Log lines of a stage: information to stdout, warnings and errors to stderr. Only rank 0 speaks.
#pragma once

#include <fmt/format.h>

#include <string>

namespace valsalva::log {

/// quiet: no information lines. speaks: false on every rank but 0.
void configure(bool quiet, bool speaks);

void info(const std::string& line);
void warn(const std::string& line);
void error(const std::string& line);

template <class First, class... Rest>
void info(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  info(fmt::format(format, std::forward<First>(first), std::forward<Rest>(rest)...));
}
template <class First, class... Rest>
void warn(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  warn(fmt::format(format, std::forward<First>(first), std::forward<Rest>(rest)...));
}

}  // namespace valsalva::log
