// Line charts as inline SVG: visible without a script, coloured by the page's style, readable in print.
#pragma once

#include <string>
#include <vector>

#include "run_data.hpp"

namespace valsalva::report {

struct Line {
  std::string name;
  std::vector<double> x, y;  ///< NaN breaks the line
};

struct Chart {
  std::string title, x_label, y_label;
  std::vector<Line> lines;
  bool logarithmic = false;  ///< y; values <= 0 are left out
  double mark_x = 0;         ///< a vertical line, where marked
  bool marked = false;
};

/// Empty when no line has two finite points.
std::string svg(const Chart& chart);

/// Round values that cover [low, high], about `count` of them.
std::vector<double> ticks(double low, double high, int count);

/// At most about `limit` points with the same extremes: first, lowest, highest, last of each stretch.
Line thinned(const Line& line, std::size_t limit);

/// All columns of a history against `x`, one chart for each unit; columns of one unit whose sizes differ more
/// than a hundredfold get charts of their own. `skip`: columns that are not drawn.
std::vector<Chart> charts_by_unit(const Series& history, const std::string& x,
                                  const std::vector<std::string>& skip = {});

}  // namespace valsalva::report
