#include "osteomill/surface/scale_bar.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(ScaleBar, HasARoundLengthThatFits) {
  EXPECT_DOUBLE_EQ(scale_bar_length_mm(6.3), 5);
  EXPECT_DOUBLE_EQ(scale_bar_length_mm(4.9), 2);
  EXPECT_DOUBLE_EQ(scale_bar_length_mm(1.4), 1);
  EXPECT_DOUBLE_EQ(scale_bar_length_mm(130), 100);
  EXPECT_DOUBLE_EQ(scale_bar_length_mm(0.03), 0.02);
}

TEST(ScaleBar, IsAsLongAsItSays) {
  Image image{200, 150, std::vector<unsigned char>(3 * 200 * 150, 255)};
  draw_scale_bar(image, 0.1);
  // A quarter of 20 mm: a bar of 5 mm, 50 pixels.
  int longest = 0;
  for (int y = 0; y < image.height; ++y) {
    int run = 0;
    for (int x = 0; x < image.width; ++x) {
      run = image.pixel(x, y)[0] < 128 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_EQ(longest, 50);
}

TEST(ScaleBar, StaysInATinyImage) {
  Image image{3, 2, std::vector<unsigned char>(3 * 3 * 2, 255)};
  draw_scale_bar(image, 1);
  EXPECT_EQ(image.rgb.size(), 18u);
}

}  // namespace
}  // namespace osteomill
