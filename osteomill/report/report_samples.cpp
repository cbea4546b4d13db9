#include "osteomill/report/report_samples.h"

#include <algorithm>

#include <png.h>

namespace osteomill::testing_support {

std::vector<unsigned char> sample_png(bool milled, int width, int height) {
  std::vector<unsigned char> pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x - 0.5 * width) / (0.4 * height);
      const double v = (0.5 * height - y) / (0.4 * height);
      const double depth = 1 - u * u - v * v;
      double shade =
          depth > 0 ? 0.25 + 0.7 * std::max(0.0, 0.4 * u + 0.5 * v + 0.75 * std::sqrt(depth)) : 1.0;
      if (milled && depth > 0 && std::hypot(u - 0.1, v - 0.3) < 0.25) shade *= 0.4;
      const auto level = static_cast<unsigned char>(255 * std::clamp(shade, 0.0, 1.0));
      pixels.insert(pixels.end(), {level, static_cast<unsigned char>(level * 0.97),
                                   static_cast<unsigned char>(level * 0.88)});
    }
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t bytes = 0;
  png_image_write_get_memory_size(image, bytes, 0, pixels.data(), 0, nullptr);
  std::vector<unsigned char> png(bytes);
  png_image_write_to_memory(&image, png.data(), &bytes, 0, pixels.data(), 0, nullptr);
  png.resize(bytes);
  return png;
}

}  // namespace osteomill::testing_support
