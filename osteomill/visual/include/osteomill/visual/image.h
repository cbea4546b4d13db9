#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace osteomill {

/// Pixels of red, green, blue, a byte each, row by row from the top left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> rgb;

  /// Returns the first of the pixel's three bytes; the pixel must lie in the image.
  unsigned char* pixel(int x, int y) { return rgb.data() + offset(x, y); }
  const unsigned char* pixel(int x, int y) const { return rgb.data() + offset(x, y); }

 private:
  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(x) + static_cast<std::size_t>(width) * static_cast<std::size_t>(y));
  }
};

/// Returns a smaller image, of width / factor x height / factor pixels: each is the mean of a square of
/// `factor` x `factor` pixels. `factor` is 1 or more; columns at the right and rows at the bottom that fill
/// no square are dropped.
Image averaged_down(const Image& image, int factor);

/// Returns the image as the bytes of a PNG file. Throws std::invalid_argument if the number of bytes in `rgb`
/// is not that of width and height.
std::vector<unsigned char> encode_png(const Image& image);

/// Returns the image of a PNG file's bytes; where it is transparent, white shows through. Returns nothing if
/// the bytes are not a whole PNG of at most 4096 x 4096 pixels.
std::optional<Image> decode_png(std::span<const unsigned char> png);

/// Writes a PNG file, whole or not at all. Throws InputError, naming the file, if it cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace osteomill
