// What a result came from: digests of inputs and parameters, version, machine.
#pragma once

#include <filesystem>
#include <string>

namespace valsalva {

/// Lower-case hexadecimal SHA-256.
std::string sha256_of_text(const std::string& text);
/// Of a file, or of a folder (names and contents of its files, sorted). EnvironmentError when unreadable.
std::string sha256_of_path(const std::filesystem::path& path);
/// Release and, when built from a checkout, the commit.
std::string version();
double peak_rss_MiB();

}  // namespace valsalva
