#include "tests/support/report_samples.h"

#include <algorithm>

#include "osteomill/visual/image.h"

namespace osteomill::testing_support {

std::vector<unsigned char> sample_png(bool milled, int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x - 0.5 * width) / (0.4 * height);
      const double v = (0.5 * height - y) / (0.4 * height);
      const double depth = 1 - u * u - v * v;
      double shade =
          depth > 0 ? 0.25 + 0.7 * std::max(0.0, 0.4 * u + 0.5 * v + 0.75 * std::sqrt(depth)) : 1.0;
      if (milled && depth > 0 && std::hypot(u - 0.1, v - 0.3) < 0.25) shade *= 0.4;
      const auto level = static_cast<unsigned char>(255 * std::clamp(shade, 0.0, 1.0));
      image.rgb.insert(image.rgb.end(), {level, static_cast<unsigned char>(level * 0.97),
                                         static_cast<unsigned char>(level * 0.88)});
    }
  }
  return encode_png(image);
}

}  // namespace osteomill::testing_support
