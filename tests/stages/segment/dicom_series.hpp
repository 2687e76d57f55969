// Writes a DICOM series, for tests of reading one.
#pragma once

#include <filesystem>
#include <string>

#include "image.hpp"

namespace valsalva::test {

struct Series {
  std::string uid = "1.2.826.0.1.3680043.2.1125.1";
  double slope = 1, intercept = -1024;  ///< value = slope * stored + intercept
};

/// One file a slice of constant last index. Their names are in no order.
void write_dicom(const std::filesystem::path& folder, const segment::Image& image, const Series& series);

/// The file of slice k.
std::filesystem::path slice_file(const std::filesystem::path& folder, const Series& series, int k);

}  // namespace valsalva::test
