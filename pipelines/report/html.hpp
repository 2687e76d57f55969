// The few pieces of HTML that all chapters use.
#pragma once

#include <string>
#include <vector>

#include "render/image.hpp"

namespace valsalva::report {

std::string escape(const std::string& text);
std::string base64(const std::string& bytes);

/// A key of a summary or a column of a history, "mean_gradient_mmHg": words and unit apart. A stage before a
/// point
/// ("cycle.mean_gradient_mmHg") is left out of the words.
struct Quantity {
  std::string words;  ///< "Mean gradient"
  std::string unit;   ///< "mmHg", "mL/s", "mm²"; empty for pure numbers
};
Quantity quantity(const std::string& key);

/// Up to `digits` significant digits, no exponent for everyday sizes.
std::string number(double value, int digits = 4);
std::string duration(double seconds);

/// head: one text a column. cells: HTML, already escaped. The first cell of a row is its header.
std::string table(const std::string& caption, const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& cells);

/// What a colour bar below a picture says.
struct ColourBar {
  double low = 0, high = 1;
  std::string label;
};

struct Picture {
  std::string png;  ///< bytes
  std::string alt;  ///< what is seen, for those who do not see it
  std::string caption;
  double width_mm = 0;  ///< of the whole picture, for the scale bar; 0: none
  bool has_bar = false;
  ColourBar bar;
};

std::string figure(const Picture& picture);

/// A fold-out.
std::string details(const std::string& title, const std::string& body);

std::string paragraph(const std::string& text, const std::string& css_class = {});

}  // namespace valsalva::report
