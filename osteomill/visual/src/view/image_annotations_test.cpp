#include <algorithm>

#include <gtest/gtest.h>

#include "osteomill/visual/annotations.h"

namespace osteomill {
namespace {

Image grey_image(int width, int height, unsigned char level) {
  return {width, height,
          std::vector<unsigned char>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                                     level)};
}

// Counts the pixels in the box that are close to `level`.
int count(const Image& image, int left, int top, int right, int bottom, int level) {
  int found = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) found += std::abs(image.pixel(x, y)[0] - level) < 60 ? 1 : 0;
  }
  return found;
}

TEST(ImageAnnotations, DrawsLineAtItsScaledPosition) {
  Image image = grey_image(200, 60, 128);
  draw_annotation(image, {{{{10, 20}, {60, 20}}}, {150, 30}, ""}, kInkOnLight, 2);
  int length = 0;
  for (int x = 0; x < 200; ++x) length += image.pixel(x, 40)[0] < 60 ? 1 : 0;
  EXPECT_NEAR(length, 100, 4);
  EXPECT_LT(image.pixel(22, 40)[0], 60);
  EXPECT_EQ(image.pixel(70, 50)[0], 128);
}

TEST(ImageAnnotations, TextIsInPlaceAndLegibleOnAnyBackground) {
  for (const int ground : {0, 40, 128, 236, 255}) {
    for (const Ink& ink : {kInkOnLight, kInkOnDark}) {
      Image image = grey_image(120, 60, static_cast<unsigned char>(ground));
      draw_annotation(image, {{}, {60, 30}, "20 mm"}, ink);
      const int level = std::abs(ground - ink.level) < 60 ? ink.edge : ink.level;
      EXPECT_GT(count(image, 35, 20, 85, 40, level), 40) << ground;
      EXPECT_EQ(count(image, 0, 0, 120, 15, ground), 120 * 15);
      EXPECT_EQ(count(image, 0, 45, 120, 60, ground), 120 * 15);
    }
  }
}

TEST(ImageAnnotations, DifferentNumbersLookDifferent) {
  Image two = grey_image(120, 60, 255);
  Image five = two;
  draw_annotation(two, {{}, {60, 30}, "2 mm"}, kInkOnLight);
  draw_annotation(five, {{}, {60, 30}, "5 mm"}, kInkOnLight);
  EXPECT_NE(two.rgb, five.rgb);
}

TEST(ImageAnnotations, ClipToATinyImage) {
  Image image = grey_image(3, 2, 255);
  draw_annotation(image, {{{{-10, 1}, {60, 1}}}, {1, 1}, "100 mm"}, kInkOnLight, 3);
  EXPECT_EQ(image.rgb.size(), 18u);
}

}  // namespace
}  // namespace osteomill
