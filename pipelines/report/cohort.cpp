#include "cohort.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

}  // namespace

std::string cohort_page(const fs::path& csv, const fs::path& out) {
  const Table table_data = read_table(csv);
  const int status = table_data.column("status"), report = table_data.column("report");
  std::vector<std::string> head;
  for (std::size_t c = 0; c < table_data.names.size(); ++c) {
    if (static_cast<int>(c) == report) continue;
    const Quantity q = quantity(table_data.names[c]);
    head.push_back(q.unit.empty() ? q.words : q.words + " (" + q.unit + ")");
  }
  std::vector<std::vector<std::string>> rows;
  std::size_t failed = 0;
  for (const auto& cells : table_data.rows) {
    std::vector<std::string> row;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const int column = static_cast<int>(c);
      if (column == report) continue;
      if (column == status) {
        const bool ok = cells[c] == "ok";
        if (!ok) ++failed;
        row.push_back(fmt::format("<span class=\"{}\">{}</span>", ok ? "pass" : "fail", escape(cells[c])));
      } else if (column == 0) {
        const std::string link =
            report_link(csv, out, cells[0], report < 0 ? "" : cells[static_cast<std::size_t>(report)]);
        row.push_back(link.empty() ? escape(cells[0])
                                   : "<a href=\"" + escape(link) + "\">" + escape(cells[0]) + "</a>");
      } else {
        row.push_back(shown(cells[c]));
      }
    }
    rows.push_back(row);
  }
  // Least, mean and greatest of each numeric column over the cases that came through.
  std::vector<std::vector<std::string>> spread;
  for (std::size_t c = 1; c < table_data.names.size(); ++c) {
    double low = INFINITY, high = -INFINITY, sum = 0;
    std::size_t count = 0;
    for (const auto& cells : table_data.rows) {
      if (!is_number(cells[c]) || (status >= 0 && cells[static_cast<std::size_t>(status)] != "ok")) continue;
      const double value = std::strtod(cells[c].c_str(), nullptr);
      low = std::min(low, value);
      high = std::max(high, value);
      sum += value;
      ++count;
    }
    if (count < 2) continue;
    const Quantity q = quantity(table_data.names[c]);
    spread.push_back({escape(q.words), number(low), number(sum / static_cast<double>(count)), number(high),
                      escape(q.unit), std::to_string(count)});
  }
  const std::string name = fs::absolute(csv).parent_path().filename().string();
  std::string body = page_begin("Valsalva: " + name, "Summary of the cohort " + name);
  body += "<header><h1>" + escape(name) + "</h1>\n";
  body += paragraph(fmt::format("{} cases, {} of them not finished", rows.size(), failed), "lead") +
          "</header><main>\n";
  body += "<section id=\"cases\"><h2>Cases</h2>\n" + table("Metrics by case", head, rows) + "</section>\n";
  if (!spread.empty())
    body += "<section id=\"spread\"><h2>Spread</h2>\n" +
            table("Over the cases that came through",
                  {"Quantity", "Least", "Mean", "Greatest", "Unit", "Cases"}, spread) +
            "</section>\n";
  return body + "</main>\n" + page_end();
}

}  // namespace valsalva::report
