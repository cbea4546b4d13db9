#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace osteomill {

/// RGB image, one byte per channel, row by row from the top left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> rgb;

  /// Returns a pointer to the pixel's three bytes; the pixel must lie in the image.
  unsigned char* pixel(int x, int y) { return rgb.data() + offset(x, y); }
  const unsigned char* pixel(int x, int y) const { return rgb.data() + offset(x, y); }

 private:
  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(x) + static_cast<std::size_t>(width) * static_cast<std::size_t>(y));
  }
};

/// Returns an image reduced to width / factor x height / factor pixels, each the mean of `factor` x `factor`
/// pixels. `factor` is at least 1; incomplete blocks at the right and bottom are dropped.
Image averaged_down(const Image& image, int factor);

/// Encodes the image as PNG. Throws std::invalid_argument if the size of `rgb` does not match width and
/// height.
std::vector<unsigned char> encode_png(const Image& image);

/// Decodes a PNG, with transparency over white. Returns std::nullopt unless the bytes are a complete PNG of
/// at most 4096 x 4096 pixels.
std::optional<Image> decode_png(std::span<const unsigned char> png);

/// Writes a PNG file atomically. Throws InputError, naming the file, if it cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace osteomill
