#include "osteomill/visual/image.h"

#include <stdexcept>
#include <string>

#include <png.h>

#include "osteomill/base/atomic_file.h"

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

std::vector<unsigned char> encode_png(const Image& image) {
  if (image.width <= 0 || image.height <= 0 ||
      image.rgb.size() !=
          3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw std::invalid_argument("encode_png: the size of rgb does not match width and height");
  }
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) {
    throw std::runtime_error(std::string("encode_png: ") + header.message);
  }
  bytes.resize(size);
  return bytes;
}

std::optional<Image> decode_png(std::span<const unsigned char> png) {
  constexpr png_uint_32 kMaxSide = 4096;
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&header, png.data(), png.size()) == 0) return std::nullopt;
  if (header.width > kMaxSide || header.height > kMaxSide) {
    png_image_free(&header);
    return std::nullopt;
  }
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height),
              std::vector<unsigned char>(PNG_IMAGE_SIZE(header))};
  const png_color white{255, 255, 255};
  // Frees the header on success and on failure.
  if (png_image_finish_read(&header, &white, image.rgb.data(), 0, nullptr) == 0) return std::nullopt;
  return image;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  const std::vector<unsigned char> bytes = encode_png(image);
  write_text_atomically(path, [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  });
}

}  // namespace osteomill
