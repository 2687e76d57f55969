// Arithmetic in x, y, z (mm) and t (s), as text: + - * / ^, sin cos tan exp log sqrt abs min max atan2 ...,
// comparisons and c ? a : b, pi (muParser's grammar; angles in radians, log is the natural logarithm).
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/types.hpp"

namespace valsalva::flow_scene {

class Expression {
 public:
  /// what: names entry and key in an InputError for text that is not understood.
  Expression(const std::string& text, const std::string& what);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  double operator()(const Vec3& x, double time_s) const;
  bool changes() const { return changes_; }  ///< with t
  bool varies() const { return varies_; }    ///< with x, y or z

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  bool changes_ = false, varies_ = false;
  double value_ = 0;
};

/// Three of them.
class VectorExpression {
 public:
  VectorExpression(const std::vector<std::string>& texts, const std::string& what);
  double component(int d, const Vec3& x, double time_s) const { return part_[d](x, time_s); }
  Vec3 operator()(const Vec3& x, double time_s) const {
    return {part_[0](x, time_s), part_[1](x, time_s), part_[2](x, time_s)};
  }
  bool changes() const { return part_[0].changes() || part_[1].changes() || part_[2].changes(); }
  bool varies() const { return part_[0].varies() || part_[1].varies() || part_[2].varies(); }

 private:
  std::array<Expression, 3> part_;
};

}  // namespace valsalva::flow_scene
