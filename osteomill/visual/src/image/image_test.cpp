#include "osteomill/visual/image.h"

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(AveragedDown, AveragesBlocksAndDropsLeftoverColumn) {
  // Red: 2 x 2 blocks of 0, 10, 20, 30 and of 200; green: 100; and an odd column.
  Image image{5, 2, {}};
  for (const int red : {0, 10, 200, 200, 77, 20, 30, 200, 200, 77}) {
    image.rgb.insert(image.rgb.end(), {static_cast<unsigned char>(red), 100, 0});
  }
  const Image small = averaged_down(image, 2);
  EXPECT_EQ(small.width, 2);
  EXPECT_EQ(small.height, 1);
  EXPECT_EQ(small.rgb, (std::vector<unsigned char>{15, 100, 0, 200, 100, 0}));
}

TEST(AveragedDown, KeepsPixelsAtFactorOne) {
  const Image image{2, 1, {1, 2, 3, 4, 5, 6}};
  EXPECT_EQ(averaged_down(image, 1).rgb, image.rgb);
}

}  // namespace
}  // namespace osteomill
