// One entry of a repeated table of the case file, with messages that say where.
#pragma once

#include <string>
#include <vector>

#include "assembly/time_table.hpp"
#include "core/case.hpp"
#include "core/errors.hpp"
#include "core/types.hpp"

namespace valsalva::assembly {

class Entry {
 public:
  Entry(const Case& scene, const std::string& table, const Case& entry)
      : table_(table),
        in_(entry),
        what_(fmt::format("{}: [[{}]] '{}'", scene.file().string(), table, text("name"))) {
    if (text("name").empty()) fail("name is missing; expected one");
  }
  const std::string& text(const std::string& key) const { return in_.text(table_ + "." + key); }
  double real(const std::string& key) const { return in_.real(table_ + "." + key); }
  bool boolean(const std::string& key) const { return in_.boolean(table_ + "." + key); }
  const std::vector<double>& reals(const std::string& key) const { return in_.reals(table_ + "." + key); }
  const std::vector<std::string>& texts(const std::string& key) const {
    return in_.texts(table_ + "." + key);
  }
  bool is_set(const std::string& key) const { return in_.is_set(table_ + "." + key); }
  Vec3 vector(const std::string& key) const {
    const auto& v = reals(key);
    return {v[0], v[1], v[2]};
  }
  Vec3 direction(const std::string& key) const {
    const Vec3 v = vector(key);
    if (!(v.norm() > 0)) fail(fmt::format("{} is zero; expected a direction", key));
    return v.normalized();
  }
  TimeTable table(const TimeTable& standard) const {
    if (reals("time_s").empty() && reals("factor").empty()) return standard;
    return {reals("time_s"), reals("factor"), what_};
  }
  [[noreturn]] void fail(const std::string& message) const { throw InputError("{}: {}", what_, message); }
  const std::string& what() const { return what_; }

 private:
  std::string table_;
  const Case& in_;
  std::string what_;
};

}  // namespace valsalva::assembly
