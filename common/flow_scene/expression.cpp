#include "flow_scene/expression.hpp"

#include <muParser.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::flow_scene {

struct Expression::Parser {
  mu::Parser parser;
  std::array<double, 4> variable{};
};

Expression::Expression(const std::string& text, const std::string& what)
    : parser_(std::make_unique<Parser>()) {
  mu::Parser& parser = parser_->parser;
  const std::array<const char*, 4> names{"x", "y", "z", "t"};
  try {
    for (int i = 0; i < 4; ++i) parser.DefineVar(names[i], &parser_->variable[i]);
    parser.DefineConst("pi", std::numbers::pi);
    parser.SetExpr(text);
    const auto& used = parser.GetUsedVar();
    changes_ = used.count("t") > 0;
    varies_ = used.size() > (changes_ ? 1u : 0u);
    value_ = parser.Eval();
  } catch (const mu::Parser::exception_type& error) {
    throw InputError(
        "{}: '{}' is not understood ({}); expected arithmetic in x, y, z, t such as \"sin(pi*x)\"", what,
        text, error.GetMsg());
  }
  if (!changes_ && !varies_ && !std::isfinite(value_))
    throw InputError("{}: '{}' is {}; expected a finite number", what, text, value_);
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

double Expression::operator()(const Vec3& x, double time_s) const {
  if (!changes_ && !varies_) return value_;
  parser_->variable = {x[0], x[1], x[2], time_s};
  return parser_->parser.Eval();
}

namespace {

const std::vector<std::string>& three(const std::vector<std::string>& texts, const std::string& what) {
  if (texts.size() != 3)
    throw InputError("{} has {} entries; expected three expressions", what, texts.size());
  return texts;
}

}  // namespace

VectorExpression::VectorExpression(const std::vector<std::string>& texts, const std::string& what)
    : part_{Expression(three(texts, what)[0], what), Expression(texts[1], what), Expression(texts[2], what)} {
}

}  // namespace valsalva::flow_scene
