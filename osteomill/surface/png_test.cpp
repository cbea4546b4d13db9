#include "osteomill/surface/png.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <gtest/gtest.h>
#include <png.h>

#include "osteomill/files/input_error.h"

namespace osteomill {
namespace {

Image colourful_image() {
  Image image{37, 21, {}};
  for (int n = 0; n < 3 * 37 * 21; ++n) image.rgb.push_back(static_cast<unsigned char>(n * n % 251));
  return image;
}

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

TEST(Png, ComesBackAsItWent) {
  const Image image = colourful_image();
  const Image back = decoded(encode_png(image));
  EXPECT_EQ(back.width, image.width);
  EXPECT_EQ(back.height, image.height);
  EXPECT_EQ(back.rgb, image.rgb);
}

TEST(Png, IsWrittenToAFileByteForByte) {
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
