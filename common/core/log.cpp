#include "core/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace valsalva::log {
namespace {

spdlog::logger& out() {
  static auto logger = [] {
    auto created = spdlog::stdout_logger_mt("valsalva");
    created->set_pattern("%v");
    created->flush_on(spdlog::level::info);
    return created;
  }();
  return *logger;
}

spdlog::logger& err() {
  static auto logger = [] {
    auto created = spdlog::stderr_logger_mt("valsalva-errors");
    created->set_pattern("%l: %v");
    created->flush_on(spdlog::level::info);
    return created;
  }();
  return *logger;
}

}  // namespace

void configure(bool quiet, bool speaks) {
  out().set_level(!speaks || quiet ? spdlog::level::off : spdlog::level::info);
  err().set_level(speaks ? spdlog::level::info : spdlog::level::off);
}

void info(const std::string& line) {
  out().info(line);
}
void warn(const std::string& line) {
  err().warn(line);
}
void error(const std::string& line) {
  err().error(line);
}

}  // namespace valsalva::log
