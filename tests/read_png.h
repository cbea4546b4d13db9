#pragma once

#include <filesystem>
#include <stdexcept>

#include <png.h>

#include "osteomill/surface/image.h"

namespace osteomill::testing_support {

/// By libpng alone, so that what our own writer wrote is held against something else.
inline Image read_png(const std::filesystem::path& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) {
    throw std::runtime_error(path.string() + ": " + header.message);
  }
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  if (png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr) == 0) {
    throw std::runtime_error(path.string() + ": " + header.message);
  }
  return image;
}

}  // namespace osteomill::testing_support
