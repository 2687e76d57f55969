#include "chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "html.hpp"

namespace valsalva::report {
namespace {

constexpr double width = 720, height = 300;
constexpr double left = 62, right = 14, top = 12, bottom = 44;

struct Axis {
  double low, high, from, to;
  bool logarithmic;
  double operator()(double value) const {
    const double v = logarithmic ? std::log10(value) : value;
    return from + (v - low) / (high - low) * (to - from);
  }
};

bool drawable(double x, double y, bool logarithmic) {
  return std::isfinite(x) && std::isfinite(y) && (!logarithmic || y > 0);
}

std::string path_of(const Line& line, const Axis& x, const Axis& y) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!drawable(line.x[i], line.y[i], y.logarithmic)) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? 'L' : 'M', x(line.x[i]), y(line.y[i]));
    pen_down = true;
  }
  return path;
}

std::string tick_text(double value, double step) {
  const int decimals = step >= 1 ? 0 : std::min(8, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  if (value != 0 && (std::abs(value) >= 1e6 || std::abs(value) < 1e-4)) return fmt::format("{:.2g}", value);
  return fmt::format("{:.{}f}", value + 0.0, decimals);
}

}  // namespace

std::vector<double> ticks(double low, double high, int count) {
  const double rough = (high - low) / count;
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * decade;
  for (double factor : {5.0, 2.0, 1.0})
    if (factor * decade >= rough * 0.999) step = factor * decade;
  std::vector<double> result;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    result.push_back(k * step);
  return result;
}

Line thinned(const Line& line, std::size_t limit) {
  const std::size_t n = line.x.size();
  if (n <= limit) return line;
  Line result;
  result.name = line.name;
  const std::size_t stretches = std::max<std::size_t>(1, limit / 4);
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t begin = s * n / stretches, end = (s + 1) * n / stretches;
    std::vector<std::size_t> chosen{begin, end - 1};
    const auto less = [&](double a, double b) { return std::isnan(b) ? !std::isnan(a) : a < b; };
    const auto first = line.y.begin() + static_cast<long>(begin),
               last = line.y.begin() + static_cast<long>(end);
    chosen.push_back(static_cast<std::size_t>(std::min_element(first, last, less) - line.y.begin()));
    const auto greater = [&](double a, double b) { return std::isnan(b) ? !std::isnan(a) : a > b; };
    chosen.push_back(static_cast<std::size_t>(std::min_element(first, last, greater) - line.y.begin()));
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    for (std::size_t i : chosen) {
      result.x.push_back(line.x[i]);
      result.y.push_back(line.y[i]);
    }
  }
  return result;
}

std::string svg(const Chart& chart) {
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
  std::size_t most = 0;
  for (const Line& line : chart.lines) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!drawable(line.x[i], line.y[i], chart.logarithmic)) continue;
      const double y = chart.logarithmic ? std::log10(line.y[i]) : line.y[i];
      x0 = std::min(x0, line.x[i]);
      x1 = std::max(x1, line.x[i]);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
      ++count;
    }
    most = std::max(most, count);
  }
  if (most < 2 || !(x1 > x0)) return {};
  if (y1 - y0 < 1e-9 * std::max(std::abs(y0), std::abs(y1)) || y1 == y0) {
    const double pad = y0 == 0 ? 1 : 0.1 * std::abs(y0);
    y0 -= pad;
    y1 += pad;
  } else if (!chart.logarithmic) {
    if (y0 > 0 && y0 < 0.4 * y1) y0 = 0;
    const double pad = 0.05 * (y1 - y0);
    y1 += pad;
    if (y0 != 0) y0 -= pad;
  }
  const Axis x{x0, x1, left, width - right, false};
  const Axis y{y0, y1, height - bottom, top, chart.logarithmic};

  std::string out = fmt::format(
      "<svg class=\"chart\" role=\"img\" viewBox=\"0 0 {} {}\" data-x=\"{:.9g} {:.9g}\" data-y=\"{:.9g} "
      "{:.9g}\" "
      "data-log=\"{}\" aria-label=\"{}\">",
      width, height, x0, x1, y0, y1, chart.logarithmic ? 1 : 0,
      escape(chart.title + ": " + chart.y_label + " against " + chart.x_label));
  out += fmt::format("<title>{}</title>", escape(chart.title));

  const auto x_ticks = ticks(x0, x1, 8);
  const double x_step = x_ticks.size() > 1 ? x_ticks[1] - x_ticks[0] : x1 - x0;
  for (double t : x_ticks)
    out += fmt::format("<text class=\"t\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>", x(t),
                       height - bottom + 16, tick_text(t, x_step));
  std::vector<double> y_ticks;
  if (chart.logarithmic)
    for (double k = std::ceil(y0); k <= y1; ++k) y_ticks.push_back(std::pow(10, k));
  if (y_ticks.size() < 2 && chart.logarithmic) {
    y_ticks.clear();
    for (double t : ticks(std::pow(10, y0), std::pow(10, y1), 5))
      if (t > 0) y_ticks.push_back(t);
  }
  if (!chart.logarithmic) y_ticks = ticks(y0, y1, 5);
  const double y_step = y_ticks.size() > 1 ? y_ticks[1] - y_ticks[0] : y1 - y0;
  for (double t : y_ticks)
    out += fmt::format(
        "<line class=\"g{}\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text class=\"t\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
        t == 0 ? " zero" : "", left, width - right, y(t), y(t), left - 6, y(t) + 4,
        chart.logarithmic ? number(t, 3) : tick_text(t, y_step));
  out += fmt::format("<text class=\"a\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                     0.5 * (left + width - right), height - 8, escape(chart.x_label));
  out += fmt::format(
      "<text class=\"a\" transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
      0.5 * (top + height - bottom), escape(chart.y_label));
  if (chart.marked && chart.mark_x >= x0 && chart.mark_x <= x1)
    out += fmt::format("<line class=\"mark\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>",
                       x(chart.mark_x), top, height - bottom);
  for (std::size_t k = 0; k < chart.lines.size(); ++k) {
    const Line line = thinned(chart.lines[k], 1200);
    out += fmt::format("<path class=\"s s{}\" data-name=\"{}\" d=\"{}\"/>", k % 8, escape(line.name),
                       path_of(line, x, y));
  }
  out += "<g class=\"hover\"></g></svg>";
  std::string legend;
  if (chart.lines.size() > 1)
    for (std::size_t k = 0; k < chart.lines.size(); ++k)
      legend += fmt::format("<span><i class=\"k s{}\"></i>{}</span>", k % 8, escape(chart.lines[k].name));
  return "<figure class=\"plot\"><figcaption>" + escape(chart.title) + "</figcaption>" +
         (legend.empty() ? "" : "<div class=\"legend\">" + legend + "</div>") + out + "</figure>\n";
}

std::vector<Chart> charts_by_unit(const Series& history, const std::string& x,
                                  const std::vector<std::string>& skip) {
  const std::vector<double>* abscissa = history.find(x);
  if (!abscissa) return {};
  struct Group {
    std::string unit;
    double size;
    Chart chart;
  };
  std::vector<Group> groups;
  for (std::size_t c = 0; c < history.names.size(); ++c) {
    const std::string& name = history.names[c];
    if (name == x || std::find(skip.begin(), skip.end(), name) != skip.end()) continue;
    double size = 0;
    for (double v : history.columns[c])
      if (std::isfinite(v)) size = std::max(size, std::abs(v));
    if (size == 0) continue;
    Quantity q = quantity(name);
    std::vector<double> column = history.columns[c];
    if (q.unit == "s" && size < 0.01) {
      q.unit = "µs";
      for (double& v : column) v *= 1e6;
      size *= 1e6;
    }
    const bool difference =
        name.find("gradient") != std::string::npos || name.find("difference") != std::string::npos;
    if (difference) q.unit += " ";  // a chart of its own: its zero means something else
    const auto fits = [&](const Group& g) {
      return !q.unit.empty() && g.unit == q.unit && g.chart.lines.size() < 6 && size < 100 * g.size &&
             g.size < 100 * size;
    };
    auto group = std::find_if(groups.begin(), groups.end(), fits);
    if (group == groups.end()) {
      groups.push_back({q.unit, size, {}});
      group = groups.end() - 1;
    }
    group->chart.lines.push_back({q.words, *abscissa, std::move(column)});
  }
  const Quantity qx = quantity(x);
  std::vector<Chart> charts;
  for (Group& group : groups) {
    Chart& chart = group.chart;
    chart.x_label = qx.unit.empty() ? qx.words : qx.words + " (" + qx.unit + ")";
    chart.title = chart.lines.front().name;
    for (std::size_t k = 1; k < chart.lines.size(); ++k) {
      std::string name = chart.lines[k].name;
      if (name.size() > 1 && !std::isupper(static_cast<unsigned char>(name[1])))
        name[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(name[0])));
      chart.title += (k + 1 == chart.lines.size() ? " and " : ", ") + name;
    }
    chart.y_label = group.unit.empty() ? chart.title : group.unit.substr(0, group.unit.find(' '));
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace valsalva::report
