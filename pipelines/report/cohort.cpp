#include "cohort.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "chapters.hpp"
#include "core/errors.hpp"
#include "html.hpp"
#include "page.hpp"
#include "run_data.hpp"

namespace valsalva::report {
namespace fs = std::filesystem;
namespace {

struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;
  int column(const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  }
};

Table read_table(const fs::path& csv) {
  if (!fs::is_regular_file(csv))
    throw InputError("{}: no such file; give the cohort.csv that 'make cohort' wrote", csv.string());
  auto cells = parse_csv(read_file(csv));
  if (cells.size() < 2)
    throw InputError("{}: expected a header and at least one case, found {} lines; run 'make cohort' again",
                     csv.string(), cells.size());
  Table table{cells.front(), {cells.begin() + 1, cells.end()}};
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    if (table.rows[r].size() != table.names.size())
      throw InputError("{}: row {} has {} cells, the header has {}; run 'make cohort' again", csv.string(),
                       r + 2, table.rows[r].size(), table.names.size());
  return table;
}

/// Where a case's report lies, if anywhere; relative to the page.
std::string report_link(const fs::path& csv, const fs::path& out, const std::string& name,
                        const std::string& given) {
  const fs::path base = fs::absolute(csv).parent_path();
  const fs::path report = given.empty() ? base.parent_path() / name / "report.html" : base / given;
  if (!fs::exists(report)) return {};
  return fs::proximate(report, fs::absolute(out).parent_path()).generic_string();
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

std::string shown(const std::string& cell) {
  if (cell.empty()) return "–";
  return is_number(cell) ? number(std::strtod(cell.c_str(), nullptr)) : escape(cell);
}

/// Is the column one of the metrics of a stage? They are told by their stage or by their unit.
bool is_metric(const std::string& name) {
  return name.find('.') != std::string::npos || !quantity(name).unit.empty();
}

bool leads(const std::string& name) {
  for (const auto& [stage, key] : leading_metrics)
    if (name == key || name == stage + "." + key) return true;
  return false;
}

std::string with_unit(const Quantity& q) {
  return q.unit.empty() ? q.words : q.words + " (" + q.unit + ")";
}

std::string cell_html(const Table& table, const std::vector<std::string>& cells, std::size_t c,
                      const fs::path& csv, const fs::path& out) {
  if (static_cast<int>(c) == table.column("status"))
    return fmt::format("<span class=\"{}\">{}</span>", cells[c] == "ok" ? "pass" : "fail", escape(cells[c]));
  if (c != 0) return shown(cells[c]);
  const int report = table.column("report");
  const std::string link =
      report_link(csv, out, cells[0], report < 0 ? "" : cells[static_cast<std::size_t>(report)]);
  return link.empty() ? escape(cells[0]) : "<a href=\"" + escape(link) + "\">" + escape(cells[0]) + "</a>";
}

std::string overview(const Table& data, const fs::path& csv, const fs::path& out) {
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < data.names.size(); ++c)
    if (data.names[c] != "report" && (!is_metric(data.names[c]) || leads(data.names[c])))
      columns.push_back(c);
  std::vector<std::string> head;
  for (std::size_t c : columns) head.push_back(with_unit(quantity(data.names[c])));
  std::vector<std::vector<std::string>> rows;
  for (const auto& cells : data.rows) {
    rows.emplace_back();
    for (std::size_t c : columns) rows.back().push_back(cell_html(data, cells, c, csv, out));
  }
  return "<section id=\"cases\"><h2>Cases</h2>\n" + table("Leading metrics by case", head, rows) +
         "</section>\n";
}

/// One row a metric, one column a case.
std::string all_metrics(const Table& data) {
  std::vector<std::string> head{"Metric"};
  for (const auto& cells : data.rows) head.push_back(cells[0]);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t c = 1; c < data.names.size(); ++c) {
    if (!is_metric(data.names[c])) continue;
    const std::size_t point = data.names[c].find('.');
    const std::string stage = point == std::string::npos ? "" : data.names[c].substr(0, point) + ": ";
    rows.push_back({escape(stage + with_unit(quantity(data.names[c])))});
    for (const auto& cells : data.rows) rows.back().push_back(shown(cells[c]));
  }
  return rows.empty() ? "" : details("All metrics", table("All metrics by case", head, rows));
}

/// Least, mean and greatest of each leading metric over the cases that came through.
std::string spread(const Table& data) {
  const int status = data.column("status");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t c = 1; c < data.names.size(); ++c) {
    if (!leads(data.names[c])) continue;
    double low = INFINITY, high = -INFINITY, sum = 0;
    std::size_t count = 0;
    for (const auto& cells : data.rows) {
      if (!is_number(cells[c]) || (status >= 0 && cells[static_cast<std::size_t>(status)] != "ok")) continue;
      const double value = std::strtod(cells[c].c_str(), nullptr);
      low = std::min(low, value);
      high = std::max(high, value);
      sum += value;
      ++count;
    }
    if (count < 2) continue;
    const Quantity q = quantity(data.names[c]);
    rows.push_back({escape(q.words), number(low), number(sum / static_cast<double>(count)), number(high),
                    escape(q.unit), std::to_string(count)});
  }
  if (rows.empty()) return {};
  return "<section id=\"spread\"><h2>Spread</h2>\n" +
         table("Over the cases that came through", {"Quantity", "Least", "Mean", "Greatest", "Unit", "Cases"},
               rows) +
         "</section>\n";
}

}  // namespace

std::string cohort_page(const fs::path& csv, const fs::path& out) {
  const Table data = read_table(csv);
  const int status = data.column("status");
  const auto failed = std::count_if(data.rows.begin(), data.rows.end(), [&](const auto& cells) {
    return status >= 0 && cells[static_cast<std::size_t>(status)] != "ok";
  });
  const std::string name = fs::absolute(csv).parent_path().filename().string();
  return page_begin("Valsalva: " + name, "Summary of the cohort " + name) + "<header><h1>" + escape(name) +
         "</h1>\n" +
         paragraph(fmt::format("{} cases, {} of them not finished", data.rows.size(), failed), "lead") +
         "</header><main>\n" + overview(data, csv, out) + spread(data) + all_metrics(data) + "</main>\n" +
         page_end();
}

}  // namespace valsalva::report
