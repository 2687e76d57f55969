#include "core/value_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace valsalva {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

struct Writer {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(const std::string& value) const { return quoted(value); }
  std::string operator()(const std::vector<double>& value) const {
    return fmt::format("[{}]", fmt::join(value, ", "));
  }
  std::string operator()(const std::vector<std::string>& value) const {
    std::vector<std::string> parts;
    for (const std::string& part : value) parts.push_back(quoted(part));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
};

}  // namespace

std::string text_of(const Value& value) {
  return std::visit(Writer{}, value);
}

std::string text_of(const Range& range) {
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  if (low && high) return fmt::format(" in {}{}, {}]", range.low_excluded ? "(" : "[", range.low, range.high);
  if (low) return fmt::format(" {} {}", range.low_excluded ? ">" : ">=", range.low);
  if (high) return fmt::format(" <= {}", range.high);
  return {};
}

bool contains(const Range& range, double number) {
  return std::isfinite(number) && (range.low_excluded ? number > range.low : number >= range.low) &&
         number <= range.high;
}

}  // namespace valsalva
