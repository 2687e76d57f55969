// The chapters of the report, each a <section> of HTML. A stage that was not run says so in its chapter.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "page.hpp"
#include "run_data.hpp"

namespace valsalva::report {

/// Stage and metric of what a reader looks for first.
inline const std::vector<std::pair<std::string, std::string>> leading_metrics{
    {"cycle", "mean_gradient_mmHg"},
    {"cycle", "peak_gradient_mmHg"},
    {"cycle", "eoa_cm2"},
    {"cycle", "stroke_volume_mL"},
    {"cycle", "regurgitant_volume_mL"},
    {"cycle", "paravalvular_leak_mL"},
    {"deploy", "implant_depth_mm"},
    {"deploy", "expanded_diameter_annulus_mm"},
    {"crimp", "crimped_diameter_mm"},
    {"segment", "annulus_diameter_mm"}};

std::string overview_tiles(const RunData& run);
std::string chain_list(const RunData& run);

std::string anatomy_chapter(const RunData& run, const PageOptions& options);
std::string mesh_chapter(const RunData& run, const PageOptions& options);
std::string device_chapter(const RunData& run, const PageOptions& options);
std::string deployment_chapter(const RunData& run, const PageOptions& options);
std::string beat_chapter(const RunData& run, const PageOptions& options);

std::string published_chapter(const RunData& run);
std::string checks_chapter(const RunData& run);
std::string accuracy_chapter(const RunData& run);
std::string cost_chapter(const RunData& run);
std::string provenance_chapter(const RunData& run);

}  // namespace valsalva::report
