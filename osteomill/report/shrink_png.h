#pragma once

#include <optional>
#include <span>
#include <vector>

namespace osteomill {

struct ShrunkPng {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> png;
};

/// The picture averaged down by a whole number so that it is at most `most_width` wide, on white where it is
/// transparent. Nothing where `png` is not a whole PNG of at most 4096 x 4096.
std::optional<ShrunkPng> shrink_png(std::span<const unsigned char> png, int most_width);

}  // namespace osteomill
