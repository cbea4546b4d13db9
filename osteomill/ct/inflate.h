#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace osteomill {

/// Inflates a raw deflate stream (no header); nothing where it is damaged, cut short, or more than `at_most`
/// bytes.
std::optional<std::string> inflate_raw(std::string_view deflated, std::uint64_t at_most);

/// What the gzip members or the zlib stream within a file hold, found by inflating it without keeping it.
struct InflatedStream {
  std::uint64_t bytes = 0;
  /// How many compressed bytes that took.
  std::uint64_t compressed_bytes = 0;
  /// The streams came to their proper end and their checksums are right.
  bool sound = false;
};

/// `offset` is where the stream begins in the file. Stops, unsound, once there are more than `at_most` bytes.
InflatedStream measure_compressed(const std::filesystem::path& path, std::uint64_t offset,
                                  std::uint64_t at_most);

}  // namespace osteomill
