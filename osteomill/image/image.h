#pragma once

#include <cstddef>
#include <vector>

namespace osteomill {

/// Pixels of red, green, blue, a byte each, row by row from the top left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> rgb;

  /// The first of the pixel's three bytes; the pixel must lie in the image.
  unsigned char* pixel(int x, int y) { return rgb.data() + offset(x, y); }
  const unsigned char* pixel(int x, int y) const { return rgb.data() + offset(x, y); }

 private:
  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(x) + static_cast<std::size_t>(width) * static_cast<std::size_t>(y));
  }
};

/// The image smaller by a whole number (1 or more), each pixel the mean of `factor` x `factor`; what is left
/// over at the right and at the bottom is dropped.
Image averaged_down(const Image& image, int factor);

}  // namespace osteomill
