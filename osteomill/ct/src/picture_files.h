#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace osteomill {

/// Picture of one slice. Values are as stored, row by row from the top, with interleaved channels: 1 for
/// grey, 3 for red, green and blue, and one more for opacity.
struct Picture {
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::size_t channels = 1;
  /// Bits per value.
  int bits = 8;
  std::vector<float> values{};
};

/// Calls `use` with the picture in a file, or with each page in turn. Throws InputError, naming the file, if
/// it cannot be read or needs more than `max_bytes`.
void read_png(const std::filesystem::path& path, std::uint64_t max_bytes,
              const std::function<void(const Picture&)>& use);
void read_tiff(const std::filesystem::path& path, std::uint64_t max_bytes,
               const std::function<void(const Picture&)>& use);

}  // namespace osteomill
