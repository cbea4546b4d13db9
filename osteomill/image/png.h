#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "osteomill/image/image.h"

namespace osteomill {

/// The image as the bytes of a PNG file. Throws std::invalid_argument where its sizes do not agree.
std::vector<unsigned char> encode_png(const Image& image);

/// On white where the PNG is transparent. Nothing where the bytes are not a whole PNG of at most 4096 x 4096.
std::optional<Image> decode_png(std::span<const unsigned char> png);

/// Writes a PNG file, whole or not at all. Throws InputError, naming the file, where it cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace osteomill
