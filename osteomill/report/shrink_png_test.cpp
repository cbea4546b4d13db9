#include "osteomill/report/shrink_png.h"

#include <gtest/gtest.h>
#include <png.h>

#include "osteomill/report/report_samples.h"

namespace osteomill {
namespace {

std::vector<unsigned char> encoded(int width, int height, const std::vector<unsigned char>& rgb) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<unsigned char> png(bytes);
  png_image_write_to_memory(&image, png.data(), &bytes, 0, rgb.data(), 0, nullptr);
  png.resize(bytes);
  return png;
}

std::vector<unsigned char> decoded(const std::vector<unsigned char>& png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  png_image_begin_read_from_memory(&image, png.data(), png.size());
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> rgb(PNG_IMAGE_SIZE(image));
  png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr);
  return rgb;
}

TEST(ShrinkPng, Averages) {
  // Two by two blocks of 0, 10, 20 and 30 in red, 100 in green, in a row of two blocks and an odd column.
  std::vector<unsigned char> rgb;
  for (const int red : {0, 10, 200, 200, 77, 20, 30, 200, 200, 77}) {
    rgb.insert(rgb.end(), {static_cast<unsigned char>(red), 100, 0});
  }
  const auto shrunk = shrink_png(encoded(5, 2, rgb), 3);
  ASSERT_TRUE(shrunk);
  EXPECT_EQ(shrunk->width, 2);
  EXPECT_EQ(shrunk->height, 1);
  EXPECT_EQ(decoded(shrunk->png), (std::vector<unsigned char>{15, 100, 0, 200, 100, 0}));
}

TEST(ShrinkPng, ASmallPictureStaysAsItIs) {
  const auto png = testing_support::sample_png(true, 60, 40);
  const auto shrunk = shrink_png(png, 60);
  ASSERT_TRUE(shrunk);
  EXPECT_EQ(decoded(shrunk->png), decoded(png));
}

TEST(ShrinkPng, WhatIsNoWholePngGivesNothing) {
  const auto png = testing_support::sample_png(true, 60, 40);
  EXPECT_FALSE(shrink_png({}, 100));
  EXPECT_FALSE(shrink_png(std::vector<unsigned char>{1, 2, 3}, 100));
  for (const std::size_t size : {10u, 30u, 60u, 200u}) {
    EXPECT_FALSE(shrink_png(std::span(png).first(size), 100)) << size;
  }
  auto huge = png;
  huge[16] = 0x7f;
  EXPECT_FALSE(shrink_png(huge, 100));
}

}  // namespace
}  // namespace osteomill
