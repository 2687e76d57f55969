// A picture in memory and as PNG. Straight (not premultiplied) alpha, so that one picture suits light and
// dark pages.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace valsalva::report {

/// Red, green, blue in 0..1, as displayed (sRGB).
using Colour = std::array<float, 3>;

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< four bytes a pixel, rows from the top

  std::uint8_t* pixel(int x, int y) { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
  const std::uint8_t* pixel(int x, int y) const {
    return &rgba[4 * (static_cast<std::size_t>(y) * width + x)];
  }
};

/// The bytes of a PNG file. EnvironmentError when the library refuses.
std::string png(const Image& image);

/// Sequential map (dark violet, red, yellow; lightness rises evenly), t clamped to 0..1.
Colour heat(double t);

}  // namespace valsalva::report
