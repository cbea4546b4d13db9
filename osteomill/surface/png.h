#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/surface/image.h"

namespace osteomill {

/// The image as the bytes of a PNG file. Throws std::invalid_argument where the image's sizes do not agree.
std::vector<unsigned char> encode_png(const Image& image);

/// Writes `encode_png(image)`. Throws InputError naming `path` where it cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace osteomill
