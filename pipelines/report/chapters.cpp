#include "chapters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "chart.hpp"
#include "core/errors.hpp"
#include "html.hpp"
#include "pictures.hpp"
#include "published.hpp"

namespace valsalva::report {
namespace {

using nlohmann::json;

std::string section(const std::string& id, const std::string& title, const std::string& body) {
  return fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, escape(title), body);
}

/// Pictures of a stage, those without a colour bar apart from those with one; a state that cannot be drawn
/// becomes a sentence, not a failed report.
template <class Maker>
std::string gallery(const std::string& css_class, Maker&& make) {
  std::string plain, coloured;
  try {
    for (const Picture& picture : make()) (picture.has_bar ? coloured : plain) += figure(picture);
  } catch (const Error& error) {
    return paragraph(std::string("No pictures: ") + error.what(), "problem");
  }
  std::string out;
  for (const std::string& group : {plain, coloured})
    if (!group.empty()) out += "<div class=\"" + css_class + "\">" + group + "</div>\n";
  return out;
}

/// What is missing or went wrong in this stage, in words.
std::string remarks(const StageData& stage) {
  std::string out;
  if (!stage.present) {
    out += paragraph(fmt::format("The stage '{}' has not been run for this case.", stage.name), "absent");
    return out;
  }
  if (!stage.summary)
    out += paragraph(fmt::format("'{}' left no readable summary.json.", stage.name), "absent");
  if (!stage.state)
    out += paragraph(fmt::format("'{}' left no readable state: no pictures of it.", stage.name), "absent");
  if (stage.state && !stage.state->final)
    out +=
        paragraph(fmt::format("The newest state of '{}' is not final: what is shown is a stage on its way.",
                              stage.name),
                  "problem");
  for (const std::string& problem : stage.problems) out += paragraph(problem, "problem");
  const std::string status = stage.status();
  if (stage.summary && status != "ok")
    out += paragraph(fmt::format("Status of '{}': {}.", stage.name, status), "problem");
  return out;
}

const json* member(const StageData& stage, const char* key) {
  if (!stage.summary) return nullptr;
  const auto found = stage.summary->find(key);
  return found == stage.summary->end() ? nullptr : &*found;
}

std::string notes(const StageData& stage) {
  const json* notes = member(stage, "notes");
  if (!notes || !notes->is_object() || notes->empty()) return {};
  std::string out = "<ul class=\"notes\">";
  for (const auto& [key, text] : notes->items())
    out += "<li><b>" + escape(quantity(key).words) + ":</b> " +
           escape(text.is_string() ? text.get<std::string>() : text.dump()) + "</li>";
  return out + "</ul>\n";
}

std::string metric_table(const StageData& stage) {
  const json* metrics = member(stage, "metrics");
  if (!metrics || !metrics->is_object() || metrics->empty()) return {};
  std::vector<std::vector<std::string>> rows;
  for (const auto& [key, value] : metrics->items()) {
    const Quantity q = quantity(key);
    rows.push_back({escape(q.words), value.is_number() ? number(value.get<double>()) : "not available",
                    escape(q.unit), "<code>" + escape(key) + "</code>"});
  }
  return details(
      "All numbers of " + stage.name,
      table("Metrics of " + stage.name, {"Quantity", "Value", "Unit", "Name in summary.json"}, rows));
}

std::string time_column(const Series& history) {
  for (const char* name : {"time_s", "t_s"})
    if (history.find(name)) return name;
  return history.names.empty() ? "" : history.names.front();
}

std::string all_charts(const std::vector<Chart>& charts) {
  std::string out;
  for (const Chart& chart : charts) out += svg(chart);
  return out.empty() ? "" : "<div class=\"plots\">" + out + "</div>\n";
}

std::string history_charts(const StageData& stage) {
  if (!stage.history) return {};
  const std::string charts =
      all_charts(charts_by_unit(*stage.history, time_column(*stage.history), {"step"}));
  return charts.empty() ? "" : details("Histories of " + stage.name, charts);
}

/// Radial force against diameter, from the columns of crimp's history whatever they are called in full.
std::string force_curve(const StageData& crimp) {
  if (!crimp.history) return {};
  const Series& history = *crimp.history;
  const auto column = [&](const std::vector<std::string>& parts) -> std::string {
    for (const std::string& name : history.names)
      if (std::all_of(parts.begin(), parts.end(),
                      [&](const auto& p) { return name.find(p) != std::string::npos; }))
        return name;
    return {};
  };
  const std::string force = column({"radial_force", "_N"});
  std::string x = column({"diameter", "_mm"});
  if (x.empty()) x = column({"radius", "_mm"});
  if (force.empty() || x.empty()) return {};
  const Quantity qx = quantity(x), qy = quantity(force);
  return all_charts({{"Radial force against diameter",
                      qx.words + " (" + qx.unit + ")",
                      qy.words + " (" + qy.unit + ")",
                      {{qy.words, *history.find(x), *history.find(force)}}}});
}

std::string tile(const std::string& words, double value, const std::string& unit) {
  return fmt::format("<div class=\"tile\"><b>{} <small>{}</small></b><span>{}</span></div>", number(value, 3),
                     escape(unit), escape(words));
}

}  // namespace

std::string overview_tiles(const RunData& run) {
  std::string out;
  for (const auto& [stage, key] : leading_metrics)
    if (const auto value = run.stage(stage).metric(key)) {
      const Quantity q = quantity(key);
      out += tile(q.words, *value, q.unit);
    }
  return out.empty() ? "" : "<div class=\"tiles\">" + out + "</div>\n";
}

std::string chain_list(const RunData& run) {
  std::string out = "<ul class=\"chain\" aria-label=\"Status of the stages\">";
  for (const StageData& stage : run.stages)
    out += fmt::format("<li class=\"{}\">{}: {}</li>", escape(stage.status()), stage.name,
                       escape(stage.status()));
  return out + "</ul>\n";
}

std::string anatomy_chapter(const RunData& run, const PageOptions& options) {
  const StageData& stage = run.stage("segment");
  std::string body = remarks(stage);
  if (!stage.contours_png.empty()) {
    Picture contours;
    contours.png = stage.contours_png;
    contours.alt = "Slices of the image with the contours of the segmented lumen drawn over them";
    contours.caption = "Contours of the segmented lumen over slices of the image";
    body += "<div class=\"wide\">" + figure(contours) + "</div>\n";
  }
  body += gallery("pictures", [&] { return anatomy_pictures(run, options.picture_width); });
  body += notes(stage) + metric_table(stage);
  return section("anatomy", "1. Anatomy from the image", body);
}

std::string mesh_chapter(const RunData& run, const PageOptions& options) {
  const StageData& stage = run.stage("mesher");
  std::string body = remarks(stage);
  body += gallery("pictures", [&] { return mesh_pictures(run, options.picture_width); });
  return section("mesh", "2. Meshes and native leaflets", body + notes(stage) + metric_table(stage));
}

std::string device_chapter(const RunData& run, const PageOptions& options) {
  const StageData &stent = run.stage("stent"), &crimp = run.stage("crimp");
  std::string body = remarks(stent) + remarks(crimp);
  body += gallery("pictures small", [&] { return device_pictures(run, options.picture_width); });
  body += force_curve(crimp);
  body += notes(stent) + notes(crimp) + history_charts(crimp) + metric_table(stent) + metric_table(crimp);
  return section("device", "3. The device, expanded and crimped", body);
}

std::string deployment_chapter(const RunData& run, const PageOptions& options) {
  const StageData& stage = run.stage("deploy");
  std::string body = remarks(stage);
  body += gallery("pictures", [&] { return deployed_pictures(run, options.picture_width); });
  return section("deployment", "4. Deployment",
                 body + notes(stage) + history_charts(stage) + metric_table(stage));
}

namespace {

/// The waveforms a reader looks for, with the pressure difference over the valve; the rest in a fold-out.
std::string waveforms(const Series& history) {
  const std::string x = time_column(history);
  Series series = history;
  const auto *before = history.find("p_lvot_mmHg"), *after = history.find("p_ao_mmHg");
  if (before && after) {
    series.names.push_back("pressure_difference_lvot_to_ao_mmHg");
    series.columns.push_back(*before);
    for (std::size_t i = 0; i < before->size(); ++i) series.columns.back()[i] -= (*after)[i];
  }
  std::vector<Chart> first, rest;
  for (Chart& chart : charts_by_unit(series, x, {"step", "beat"})) {
    static const std::vector<std::string> units{"mmHg", "mL/s", "cm²", "cm/s", "µs"};
    const bool leads = std::find(units.begin(), units.end(), chart.y_label) != units.end();
    (leads ? first : rest).push_back(std::move(chart));
  }
  const std::string charts = all_charts(first), others = all_charts(rest);
  return (charts.empty() ? "" : "<h3>Waveforms</h3>\n" + charts) +
         (others.empty() ? "" : details("Further histories of the beat", others));
}

}  // namespace

std::string beat_chapter(const RunData& run, const PageOptions& options) {
  const StageData& stage = run.stage("cycle");
  std::string body = remarks(stage);
  body += gallery("pictures", [&] { return beat_pictures(run, options.picture_width); });
  if (stage.history) body += waveforms(*stage.history);
  return section("beat", "5. The beating valve", body + notes(stage) + metric_table(stage));
}

std::string published_chapter(const RunData& run) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> used;
  for (const PublishedFigure& figure : published().figures) {
    if (!figure.concerns(run.case_name)) continue;
    const auto value = run.stage(figure.stage).metric(figure.metric);
    if (!value) continue;
    const Quantity q = quantity(figure.metric);
    rows.push_back({escape(q.words), number(*value) + " " + escape(q.unit),
                    escape(figure.shown) + " " + escape(q.unit), escape(figure.compare(*value)),
                    escape(figure.what), escape(figure.source + ", " + figure.where)});
    if (std::find(used.begin(), used.end(), figure.source) == used.end()) used.push_back(figure.source);
  }
  if (rows.empty())
    return section("published", "6. Beside published figures",
                   paragraph("This run has no metric for which a published figure is known.", "absent"));
  std::string body = paragraph(
      "Published figures belong to their own patients, devices and boundary conditions. The table says where "
      "this run "
      "lies; it does not judge.",
      "quiet");
  body += table("Metrics beside published figures",
                {"Quantity", "This run", "Published", "This run lies", "What was published", "Source"}, rows);
  body += "<ul class=\"quiet\">";
  for (const std::string& name : used) {
    const PublishedSource& source = published().sources.at(name);
    body += "<li>" + escape(name + ": " + source.title + ", doi " + source.doi) + "</li>";
  }
  return section("published", "6. Beside published figures", body + "</ul>\n");
}

std::string checks_chapter(const RunData& run) {
  std::vector<std::vector<std::string>> rows;
  for (const StageData& stage : run.stages) {
    const json* checks = member(stage, "checks");
    if (!checks || !checks->is_object()) continue;
    for (const auto& [key, check] : checks->items()) {
      if (!check.is_object()) continue;
      const Quantity q = quantity(key);
      const auto value = [&check = check](const char* name) {
        const auto found = check.find(name);
        return found != check.end() && found->is_number() ? number(found->get<double>()) : std::string("–");
      };
      const bool pass = check.value("pass", false);
      rows.push_back({escape(q.words), stage.name, value("value"), value("limit"), escape(q.unit),
                      pass ? "<span class=\"pass\">pass</span>" : "<span class=\"fail\">fail</span>"});
    }
  }
  const std::string body = rows.empty() ? paragraph("No stage has reported a check.", "absent")
                                        : table("Balances and checks of the stages",
                                                {"Check", "Stage", "Value", "Limit", "Unit", "Result"}, rows);
  return section("checks", "7. Balances and checks", body);
}

namespace {

/// Any JSON as readable HTML: text as a paragraph, an object as a table.
std::string readable(const std::string& title, const json& value) {
  if (value.is_string()) return paragraph(value.get<std::string>());
  if (!value.is_object()) return paragraph(value.dump());
  std::vector<std::vector<std::string>> rows;
  for (const auto& [key, entry] : value.items()) {
    const Quantity q = quantity(key);
    std::string text = entry.is_number()   ? number(entry.get<double>())
                       : entry.is_string() ? entry.get<std::string>()
                                           : entry.dump();
    rows.push_back({escape(q.words), escape(text), escape(q.unit)});
  }
  return table(title, {"Quantity", "Value", "Unit"}, rows);
}

}  // namespace

std::string accuracy_chapter(const RunData& run) {
  std::string body;
  for (const StageData& stage : run.stages) {
    const json* extra = member(stage, "extra");
    if (!extra || !extra->is_object() || !extra->contains("accuracy")) continue;
    body += "<h3>" + stage.name + "</h3>\n" + readable("Accuracy of " + stage.name, (*extra)["accuracy"]);
  }
  if (body.empty())
    body = paragraph(
        "No stage of this run has stated an accuracy band. 'valsalva-STAGE CASE.toml --estimate' prints the "
        "band expected at each fidelity.",
        "absent");
  return section("accuracy", "8. Accuracy band", body);
}

std::string cost_chapter(const RunData& run) {
  std::vector<std::vector<std::string>> rows;
  double total = 0;
  for (const StageData& stage : run.stages) {
    if (!stage.summary) continue;
    const json& s = *stage.summary;
    const auto real = [&](const char* key) {
      const auto found = s.find(key);
      return found != s.end() && found->is_number() ? found->get<double>() : NAN;
    };
    const double wall = real("wall_s"), steps = real("steps"), simulated = real("simulated_s");
    if (std::isfinite(wall)) total += wall;
    rows.push_back({stage.name, duration(wall), steps > 0 ? number(steps, 9) : "–",
                    steps > 0 ? number(1e3 * wall / steps, 3) + " ms" : "–",
                    simulated > 0 ? number(simulated) + " s" : "–", number(real("ranks"), 3),
                    number(real("peak_rss_MiB"), 4) + " MiB", escape(s.value("fidelity", "–"))});
  }
  if (rows.empty()) return section("cost", "9. Cost", paragraph("No stage has reported its cost.", "absent"));
  rows.push_back({"all", duration(total), "", "", "", "", "", ""});
  return section("cost", "9. Cost",
                 table("What each stage took",
                       {"Stage", "Wall time", "Steps", "A step", "Simulated", "Ranks",
                        "Peak memory of a rank", "Fidelity"},
                       rows));
}

std::string provenance_chapter(const RunData& run) {
  std::vector<std::vector<std::string>> rows;
  std::string folds;
  for (const StageData& stage : run.stages) {
    if (!stage.summary && !stage.state) continue;
    const auto text = [&](const char* key) {
      return stage.summary && stage.summary->contains(key) && (*stage.summary)[key].is_string()
                 ? (*stage.summary)[key].get<std::string>()
                 : std::string("–");
    };
    std::string inputs;
    if (const json* map = member(stage, "inputs"); map && map->is_object())
      for (const auto& [path, digest] : map->items())
        inputs += "<code>" + escape(path + " " + (digest.is_string() ? digest.get<std::string>() : "")) +
                  "</code><br>";
    if (stage.state)
      for (const std::string& parent : stage.state->parents)
        inputs += "<code>parent " + escape(parent) + "</code><br>";
    rows.push_back({stage.name, escape(text("version")),
                    "<code>" + escape(text("parameters_sha256")) + "</code>", inputs.empty() ? "–" : inputs});
    if (stage.state && !stage.state->parameters.empty())
      folds += details("Effective parameters of " + stage.name,
                       "<pre>" + escape(stage.state->parameters) + "</pre>");
  }
  if (rows.empty())
    return section("provenance", "10. Provenance", paragraph("Nothing is recorded.", "absent"));
  return section(
      "provenance", "10. Provenance",
      table("Where the results come from",
            {"Stage", "Version", "SHA-256 of the parameters", "Inputs and parents with their SHA-256"},
            rows) +
          folds);
}

}  // namespace valsalva::report
