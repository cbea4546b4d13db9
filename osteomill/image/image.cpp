#include "osteomill/image/image.h"

namespace osteomill {

Image averaged_down(const Image& image, int factor) {
  Image small{image.width / factor, image.height / factor, {}};
  small.rgb.reserve(3 * static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height));
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      for (int channel = 0; channel < 3; ++channel) {
        int sum = 0;
        for (int dy = 0; dy < factor; ++dy) {
          for (int dx = 0; dx < factor; ++dx) sum += image.pixel(x * factor + dx, y * factor + dy)[channel];
        }
        small.rgb.push_back(static_cast<unsigned char>((sum + factor * factor / 2) / (factor * factor)));
      }
    }
  }
  return small;
}

}  // namespace osteomill
