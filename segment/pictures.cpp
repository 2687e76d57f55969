#include "pictures.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::segment {
namespace {

using Colour = std::array<png_byte, 3>;
constexpr Colour red{235, 40, 40}, orange{255, 160, 40}, yellow{255, 240, 60}, blue{80, 170, 255};

struct Canvas {
  int width, height;
  std::vector<png_byte> bytes;
  Canvas(int w, int h) : width(w), height(h), bytes(std::size_t(w) * h * 3, 255) {}
  void set(int i, int j, const Colour& colour) {
    std::copy(colour.begin(), colour.end(), bytes.begin() + (std::ptrdiff_t(j) * width + i) * 3);
  }
};

void write_png(const std::filesystem::path& path, const Canvas& canvas) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(canvas.width);
  image.height = png_uint_32(canvas.height);
  image.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&image, path.c_str(), 0, canvas.bytes.data(), 0, nullptr))
    throw EnvironmentError("{}: cannot be written ({})", path.string(), image.message);
}

}  // namespace

void write_contours(const std::filesystem::path& png, const Lumen& lumen,
                    const std::function<double(const Vec3&)>& brightness, const PictureOptions& options) {
  const int size = int(2 * options.half_width_mm * options.pixels_per_mm), gap = 8;
  const double middle = 0.5 * (lumen.z_lower_mm + lumen.z_upper_mm);
  struct Panel {
    Vec3 centre, right, up;
    bool along;  // shows the axis
  };
  const std::array<Panel, 4> panels{{{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), false},
                                     {{0, 0, options.z_sinus_mm}, Vec3::UnitX(), Vec3::UnitY(), false},
                                     {{0, 0, middle}, Vec3::UnitX(), Vec3::UnitZ(), true},
                                     {{0, 0, middle}, Vec3::UnitY(), Vec3::UnitZ(), true}}};
  const double pixel = 1 / options.pixels_per_mm;
  Canvas canvas(2 * size + gap, 2 * size + gap);
  for (int n = 0; n < 4; ++n) {
    const Panel& panel = panels[n];
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        const Vec3 x = panel.centre + (i + 0.5 - size / 2) * pixel * panel.right +
                       (size / 2 - j - 0.5) * pixel * panel.up;
        const double shade =
            (brightness(x) - options.window_low) / (options.window_high - options.window_low);
        const auto grey = png_byte(255 * std::clamp(shade, 0.0, 1.0));
        Colour colour{grey, grey, grey};
        const bool between = x.z() >= lumen.z_lower_mm && x.z() <= lumen.z_upper_mm;
        const double distance = lumen.distance.value(x);
        const double line = 0.8 * pixel;
        if (between && std::abs(distance - options.wall_mm) < line) colour = orange;
        if (between && std::abs(distance) < line) colour = red;
        if (lumen.calcium && std::abs(lumen.calcium->value(x)) < line) colour = yellow;
        const auto level = [&](double z) { return std::abs(x.z() - z) < 0.5 * pixel; };
        if (panel.along && distance < 3 && (level(0) || level(lumen.z_lower_mm) || level(lumen.z_upper_mm)))
          colour = blue;
        canvas.set(i + (n % 2) * (size + gap), j + (n / 2) * (size + gap), colour);
      }
  }
  write_png(png, canvas);
}

}  // namespace valsalva::segment
