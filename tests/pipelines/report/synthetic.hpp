// A run folder with made-up but plausible shapes and numbers, to test the report without running a stage.
// Nothing of it is a result.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace valsalva::report::synthetic {

/// Writes the folders of `stages` below `folder`, which becomes the case's run folder.
void write_run(const std::filesystem::path& folder, const std::set<std::string>& stages);

inline const std::set<std::string> all_stages{"segment", "mesher", "stent", "crimp", "deploy", "cycle"};

}  // namespace valsalva::report::synthetic
