// The summary page of a cohort: cases against metrics, from the table that the cohort run wrote.
//
// The first column names the case. A column `status` marks cases that are not `ok`. A column `report` gives
// the path of a case's report, relative to the table's folder; without it, ../<case>/report.html is linked
// where it exists. Metrics are columns named `stage.metric`, or `metric`. The first table shows what is not a
// metric and the leading metrics; a fold-out has them all.
#pragma once

#include <filesystem>
#include <string>

namespace valsalva::report {

/// InputError when the table has no header or no rows. `out`: where the page will be written, for the links.
std::string cohort_page(const std::filesystem::path& csv, const std::filesystem::path& out);

}  // namespace valsalva::report
