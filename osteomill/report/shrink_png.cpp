#include "osteomill/report/shrink_png.h"

#include <png.h>

namespace osteomill {

namespace {

constexpr png_uint_32 kMostPixels = 4096;

struct Pixels {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> rgb;

  std::size_t at(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

std::optional<Pixels> decoded(std::span<const unsigned char> png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, png.data(), png.size()) == 0) return std::nullopt;
  if (image.width > kMostPixels || image.height > kMostPixels) {
    png_image_free(&image);
    return std::nullopt;
  }
  image.format = PNG_FORMAT_RGB;
  Pixels pixels{static_cast<int>(image.width), static_cast<int>(image.height),
                std::vector<unsigned char>(PNG_IMAGE_SIZE(image))};
  const png_color white{255, 255, 255};
  // Frees the image whether it succeeds or not.
  if (png_image_finish_read(&image, &white, pixels.rgb.data(), 0, nullptr) == 0) return std::nullopt;
  return pixels;
}

Pixels averaged(const Pixels& in, int factor) {
  Pixels out{in.width / factor, in.height / factor, {}};
  out.rgb.resize(out.at(0, out.height));
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        int sum = 0;
        for (int dy = 0; dy < factor; ++dy) {
          for (int dx = 0; dx < factor; ++dx)
            sum += in.rgb[in.at(x * factor + dx, y * factor + dy) + channel];
        }
        out.rgb[out.at(x, y) + channel] = static_cast<unsigned char>(sum / (factor * factor));
      }
    }
  }
  return out;
}

std::optional<ShrunkPng> encoded(const Pixels& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.width);
  image.height = static_cast<png_uint_32>(pixels.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  ShrunkPng shrunk{pixels.width, pixels.height, std::vector<unsigned char>(bytes)};
  if (png_image_write_to_memory(&image, shrunk.png.data(), &bytes, 0, pixels.rgb.data(), 0, nullptr) == 0) {
    return std::nullopt;
  }
  shrunk.png.resize(bytes);
  return shrunk;
}

}  // namespace

std::optional<ShrunkPng> shrink_png(std::span<const unsigned char> png, int most_width) {
  const std::optional<Pixels> pixels = decoded(png);
  if (!pixels) return std::nullopt;
  const int factor = (pixels->width + most_width - 1) / most_width;
  // A picture flatter than the factor would vanish.
  if (factor <= 1 || pixels->height < factor) return encoded(*pixels);
  return encoded(averaged(*pixels, factor));
}

}  // namespace osteomill
