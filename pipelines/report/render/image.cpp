#include "render/image.hpp"

#include <png.h>

#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::report {

std::string png(const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = image.width;
  header.height = image.height;
  header.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr))
    throw EnvironmentError("cannot encode a picture of {} x {} pixels as PNG: {}", image.width, image.height,
                           header.message);
  bytes.resize(size);
  return bytes;
}

Colour heat(double t) {
  static constexpr std::array<Colour, 7> stops{{{0.05f, 0.03f, 0.53f},
                                                {0.36f, 0.00f, 0.65f},
                                                {0.61f, 0.09f, 0.62f},
                                                {0.80f, 0.28f, 0.47f},
                                                {0.93f, 0.47f, 0.33f},
                                                {0.99f, 0.70f, 0.18f},
                                                {0.94f, 0.97f, 0.13f}}};
  const double x = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
  const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(x), stops.size() - 2);
  const float w = static_cast<float>(x - static_cast<double>(i));
  Colour colour;
  for (int c = 0; c < 3; ++c) colour[c] = (1 - w) * stops[i][c] + w * stops[i + 1][c];
  return colour;
}

}  // namespace valsalva::report
