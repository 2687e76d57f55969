// valsalva-report: the story of a case in one HTML file that opens offline.
//
//   valsalva-report cases/demo.toml                       reads runs/demo/*, writes runs/demo/report.html
//   valsalva-report cases/demo.toml --out elsewhere/report   reads elsewhere/*, writes elsewhere/report.html
//   valsalva-report --cohort runs/cohort-a/cohort.csv --out runs/cohort-a/cohort.html
#include <filesystem>
#include <string>
#include <vector>

#include "cohort.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/run_folder.hpp"
#include "core/stage.hpp"
#include "page.hpp"
#include "scene/scene.hpp"

namespace {

namespace fs = std::filesystem;
using namespace valsalva;

void run(StageContext& context) {
  const fs::path folder = fs::absolute(context.run.path()).lexically_normal().parent_path();
  const report::RunData data = report::read_run(folder, context.scene.name());
  if (data.empty())
    throw InputError("{}: no stage has left anything to report; run 'make run CASE={}' first",
                     folder.string(), context.scene.file().string());
  report::PageOptions options;
  options.title = context.scene.text("case.title");
  options.picture_width = static_cast<int>(context.scene.integer("report.picture_width_px"));
  options.viewer_frames = static_cast<int>(context.scene.integer("report.viewer_frames"));
  const std::string html = report::page(data, options);
  write_atomically(folder / "report.html", html);

  double checks = 0, failed = 0;
  for (const report::StageData& stage : data.stages) {
    if (stage.summary) context.summary.notes["status " + stage.name] = stage.status();
    if (!stage.summary || !stage.summary->contains("checks")) continue;
    for (const auto& check : (*stage.summary)["checks"]) {
      ++checks;
      failed += check.is_object() && !check.value("pass", false);
    }
  }
  context.summary.metrics["report_size_MiB"] = static_cast<double>(html.size()) / (1 << 20);
  context.summary.metrics["checks_of_all_stages"] = checks;
  context.summary.metrics["failed_checks_of_all_stages"] = failed;
  log::info("{}", (folder / "report.html").string());
}

Estimate estimate(const Case& scene, int) {
  const double pixels = static_cast<double>(scene.integer("report.picture_width_px"));
  return {15.0 * (pixels / 800) * (pixels / 800), 700, "pictures and tables repeat the run's own numbers"};
}

/// The value after an option; empty when the option is absent.
std::string value_of(const std::vector<std::string>& arguments, const std::string& option) {
  for (std::size_t i = 0; i < arguments.size(); ++i)
    if (arguments[i] == option) {
      if (i + 1 == arguments.size()) throw InputError("{}: a value is missing after it", option);
      return arguments[i + 1];
    }
  return {};
}

int cohort_main(const std::vector<std::string>& arguments) {
  try {
    for (std::size_t i = 0; i < arguments.size(); i += 2)
      if (arguments[i] != "--cohort" && arguments[i] != "--out")
        throw InputError("{}: unknown beside --cohort; expected --cohort cohort.csv --out FILE.html",
                         arguments[i]);
    const fs::path csv = value_of(arguments, "--cohort");
    const std::string out = value_of(arguments, "--out");
    const fs::path target = out.empty() ? csv.parent_path() / "cohort.html" : fs::path(out);
    write_atomically(target, report::cohort_page(csv, target));
    log::info("{}", target.string());
    return 0;
  } catch (const Error& error) {
    log::error(error.what());
    return static_cast<int>(error.code());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  for (const std::string& argument : arguments)
    if (argument == "--cohort") return cohort_main(arguments);
  return stage_main(argc, argv,
                    {"report",
                     "Tells the story of a run in one HTML file that opens offline",
                     "  valsalva-report cases/demo.toml\n"
                     "  valsalva-report --cohort runs/cohort-a/cohort.csv --out runs/cohort-a/cohort.html",
                     declare_all,
                     {"report"},
                     run,
                     estimate,
                     {}});
}
