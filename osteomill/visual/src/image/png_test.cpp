#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <gtest/gtest.h>
#include <png.h>

#include "osteomill/base/input_error.h"
#include "osteomill/visual/image.h"

namespace osteomill {
namespace {

Image colourful_image() {
  Image image{37, 21, {}};
  for (int n = 0; n < 3 * 37 * 21; ++n) image.rgb.push_back(static_cast<unsigned char>(n * n % 251));
  return image;
}

// Decodes directly with libpng, to check our encoder against an independent reader.
Image decoded(const std::vector<unsigned char>& bytes) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) << header.message;
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  EXPECT_TRUE(png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr)) << header.message;
  return image;
}

TEST(Png, EncodesImageThatLibpngDecodesUnchanged) {
  const Image image = colourful_image();
  const Image back = decoded(encode_png(image));
  EXPECT_EQ(back.width, image.width);
  EXPECT_EQ(back.height, image.height);
  EXPECT_EQ(back.rgb, image.rgb);
}

TEST(Png, RoundTripKeepsPixels) {
  const auto back = decode_png(encode_png(colourful_image()));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->width, 37);
  EXPECT_EQ(back->rgb, colourful_image().rgb);
}

TEST(Png, RejectsInvalidTruncatedOrHugeData) {
  const std::vector<unsigned char> png = encode_png(colourful_image());
  EXPECT_FALSE(decode_png({}));
  EXPECT_FALSE(decode_png(std::vector<unsigned char>{1, 2, 3}));
  for (const std::size_t size : {10u, 30u, 60u, 200u}) {
    EXPECT_FALSE(decode_png(std::span(png).first(size))) << size;
  }
  auto huge = png;
  huge[16] = 0x7f;
  EXPECT_FALSE(decode_png(huge));
}

TEST(Png, WritesEncodedBytesToFile) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "osteomill_png_test.png";
  write_png(path, colourful_image());
  std::ifstream file(path, std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file),
                                         std::istreambuf_iterator<char>()};
  EXPECT_EQ(bytes, encode_png(colourful_image()));
  std::filesystem::remove(path);
}

TEST(Png, NamesAFileThatCannotBeWritten) {
  EXPECT_THROW(write_png("/nowhere/at/all.png", colourful_image()), InputError);
}

TEST(Png, RefusesAnImageWhoseSizesDisagree) {
  Image image = colourful_image();
  image.rgb.pop_back();
  EXPECT_THROW(encode_png(image), std::invalid_argument);
  EXPECT_THROW(encode_png({}), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
