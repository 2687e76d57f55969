#include "measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/errors.hpp"

namespace valsalva::cycle {

/// cycle/measured.csv, made into a source at build time.
extern const char* const measured_table;

namespace {

constexpr double steps_power = -1.4, cells_power = -3, error_power = 1, ranks_power = 0.77;
const std::string error_suffix = "_error_pct";

std::vector<std::string> cells_of(const std::string& line) {
  // As Python's csv writes them: cells with a comma stand in quotes.
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

double number(const std::string& text, int line, const std::string& column) {
  try {
    std::size_t end = 0;
    const double value = std::stod(text, &end);
    if (end == text.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {
  }
  throw InputError("measured beats, line {}: {} is '{}'; expected a number", line, column, text);
}

/// A power of h between the two grids around h, or the given power beyond them. rows: h ascending.
template <typename Get>
double at(const std::vector<const MeasuredBeat*>& rows, double h, double power, Get get) {
  const auto after =
      std::find_if(rows.begin(), rows.end(), [&](const auto* row) { return row->spacing_mm >= h; });
  if (after == rows.begin() || after == rows.end()) {
    const MeasuredBeat& end = after == rows.end() ? *rows.back() : *rows.front();
    return get(end) * std::pow(h / end.spacing_mm, power);
  }
  const MeasuredBeat &fine = **(after - 1), &coarse = **after;
  const double share = std::log(h / fine.spacing_mm) / std::log(coarse.spacing_mm / fine.spacing_mm);
  return get(fine) * std::pow(get(coarse) / get(fine), share);
}

}  // namespace

std::vector<MeasuredBeat> read_measured(const std::string& csv) {
  std::vector<MeasuredBeat> out;
  std::vector<std::string> names;
  std::istringstream text(csv);
  std::string line;
  for (int n = 1; std::getline(text, line); ++n) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> cells = cells_of(line);
    if (names.empty()) {
      names = cells;
      continue;
    }
    if (cells.size() != names.size())
      throw InputError("measured beats, line {}: {} cells; expected {}", n, cells.size(), names.size());
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = cells[i];
    const auto value = [&](const std::string& name) {
      const double v = number(row[name], n, name);
      if (!(v > 0)) throw InputError("measured beats, line {}: {} is {}; expected more than 0", n, name, v);
      return v;
    };
    MeasuredBeat beat;
    beat.valve = row["valve"];
    beat.spacing_mm = value("spacing_mm");
    beat.steps_per_s = value("steps") / value("simulated_s");
    const double ranks = value("ranks");
    beat.seconds_a_step = value("processor_s") / ranks * std::pow(ranks, ranks_power) / value("steps");
    beat.memory_MiB = value("memory_MiB");
    beat.basis = row["error_basis"];
    for (const std::string& name : names)
      if (name.ends_with(error_suffix) && !row[name].empty())
        beat.error_pct[name.substr(0, name.size() - error_suffix.size())] = number(row[name], n, name);
    out.push_back(std::move(beat));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const MeasuredBeat& a, const MeasuredBeat& b) { return a.spacing_mm < b.spacing_mm; });
  return out;
}

const std::vector<MeasuredBeat>& measured_beats() {
  static const std::vector<MeasuredBeat> table = read_measured(measured_table);
  return table;
}

Expectation expect(const std::vector<MeasuredBeat>& table, const std::string& valve, double h,
                   double simulated_s, int ranks) {
  if (table.empty()) throw InputError("measured beats: the table is empty; run make tradeoff");
  std::vector<const MeasuredBeat*> rows;
  for (const std::string& kind : {valve, table.front().valve}) {
    for (const MeasuredBeat& beat : table)
      if (beat.valve == kind) rows.push_back(&beat);
    if (!rows.empty()) break;
  }
  const double steps =
      simulated_s * at(rows, h, steps_power, [](const MeasuredBeat& b) { return b.steps_per_s; });
  const double each = at(rows, h, cells_power, [](const MeasuredBeat& b) { return b.seconds_a_step; });
  Expectation out;
  out.wall_s = steps * each / std::pow(ranks, ranks_power);
  out.memory_MiB = at(rows, h, cells_power, [](const MeasuredBeat& b) { return b.memory_MiB; });
  constexpr double least_pct = 1e-3;  // a difference of nothing has no power of h
  for (const auto& [figure, error] : rows.front()->error_pct) {
    if (std::any_of(rows.begin(), rows.end(),
                    [&](const auto* row) { return !row->error_pct.contains(figure); }))
      continue;
    out.error_pct[figure] = at(rows, h, error_power, [&](const MeasuredBeat& b) {
      return std::max(least_pct, b.error_pct.at(figure));
    });
  }
  const double finest = rows.front()->spacing_mm, coarsest = rows.back()->spacing_mm;
  std::string grids;
  for (const MeasuredBeat* row : rows)
    grids += fmt::format("{}{:g}", grids.empty() ? "" : ", ", row->spacing_mm);
  const std::string& kind = rows.front()->valve;
  out.basis = fmt::format("measured: {}{} at h = {} mm", kind == "device" ? "device" : kind + " valve",
                          kind == valve ? "" : ", not this kind of valve,", grids);
  if (!out.error_pct.empty())
    out.basis +=
        fmt::format("; errors against the value at h = 0 or the finest grid ({})", rows.front()->basis);
  if (h < finest)
    out.basis += fmt::format("; h = {:g} mm was not: cost and error are carried on from {:g} mm", h, finest);
  else if (h > coarsest)
    out.basis +=
        fmt::format("; h = {:g} mm was not: cost and error are carried on from {:g} mm", h, coarsest);
  return out;
}

std::string kind_of_valve(const Case& scene) {
  if (scene.has("device") || scene.has("test_section")) return "device";
  return scene.real("native.stenosis_factor") > 10 ? "stenotic" : "healthy";
}

std::string in_words(const Expectation& expectation) {
  std::string text;
  const std::pair<const char*, const char*> names[] = {{"mean_gradient_mmHg", "mean gradient"},
                                                       {"eoa_cm2", "orifice area"},
                                                       {"stroke_volume_mL", "stroke volume"},
                                                       {"regurgitant_volume_mL", "regurgitant volume"},
                                                       {"leaflet_von_mises_p99_kPa", "leaflet stress"}};
  for (const auto& [key, name] : names)
    if (const auto found = expectation.error_pct.find(key); found != expectation.error_pct.end())
      text += fmt::format("{}{} {:.2g} %", text.empty() ? "likely error: " : ", ", name, found->second);
  if (text.empty()) text = "error unknown: one grid alone was measured";
  return text + " (" + expectation.basis + ")";
}

}  // namespace valsalva::cycle
