#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace osteomill {

/// A picture of one slice. Its values are as stored, row by row from the top: `channels` beside each other
/// for each pixel, 1 for grey, 3 for red, green and blue, and one more for how opaque it is.
struct Picture {
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::size_t channels = 1;
  /// Bits of a value.
  int bits = 8;
  std::vector<float> values{};
};

/// Each calls `use` with the picture in a file, or with each of its pages in turn. Throws InputError naming
/// the file if it cannot be read, or takes more than `max_bytes`.
void read_png(const std::filesystem::path& path, std::uint64_t max_bytes,
              const std::function<void(const Picture&)>& use);
void read_tiff(const std::filesystem::path& path, std::uint64_t max_bytes,
               const std::function<void(const Picture&)>& use);

}  // namespace osteomill
