#include "osteomill/surface/scale_bar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace osteomill {

namespace {

constexpr std::array<unsigned char, 3> kInk{40, 40, 40};
constexpr int kGlyphWidth = 5;
constexpr int kGlyphHeight = 7;

struct Glyph {
  char character;
  // Rows from the top, the leftmost pixel in the highest of five bits.
  std::array<std::uint8_t, kGlyphHeight> rows;
};

constexpr std::array<Glyph, 13> kGlyphs{{
    {'0', {0b01110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110}},
    {'1', {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110}},
    {'2', {0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111}},
    {'3', {0b01110, 0b10001, 0b00001, 0b00110, 0b00001, 0b10001, 0b01110}},
    {'4', {0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010}},
    {'5', {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110}},
    {'6', {0b01110, 0b10000, 0b11110, 0b10001, 0b10001, 0b10001, 0b01110}},
    {'7', {0b11111, 0b00001, 0b00010, 0b00100, 0b00100, 0b01000, 0b01000}},
    {'8', {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110}},
    {'9', {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00001, 0b01110}},
    {'.', {0, 0, 0, 0, 0, 0b01100, 0b01100}},
    {' ', {0, 0, 0, 0, 0, 0, 0}},
    {'m', {0, 0, 0b11010, 0b10101, 0b10101, 0b10101, 0b10101}},
}};

void fill(Image& image, int left, int top, int width, int height) {
  for (int y = std::max(0, top); y < std::min(image.height, top + height); ++y) {
    for (int x = std::max(0, left); x < std::min(image.width, left + width); ++x) {
      std::copy(kInk.begin(), kInk.end(), image.pixel(x, y));
    }
  }
}

void draw_text(Image& image, std::string_view text, int left, int top, int dot) {
  for (const char character : text) {
    const auto glyph = std::find_if(kGlyphs.begin(), kGlyphs.end(),
                                    [&](const Glyph& one) { return one.character == character; });
    if (glyph == kGlyphs.end()) continue;
    for (int y = 0; y < kGlyphHeight; ++y) {
      for (int x = 0; x < kGlyphWidth; ++x) {
        const bool inked = (glyph->rows[static_cast<std::size_t>(y)] >> (kGlyphWidth - 1 - x)) & 1;
        if (inked) fill(image, left + x * dot, top + y * dot, dot, dot);
      }
    }
    left += (kGlyphWidth + 1) * dot;
  }
}

}  // namespace

double scale_bar_length_mm(double longest_mm) {
  const double power = std::pow(10.0, std::floor(std::log10(longest_mm)));
  for (const double times : {5.0, 2.0}) {
    if (times * power <= longest_mm) return times * power;
  }
  return power;
}

void draw_scale_bar(Image& image, double mm_per_pixel) {
  const double length_mm = scale_bar_length_mm(0.25 * image.width * mm_per_pixel);
  const int dot = std::max(1, image.height / 400);
  const int margin = std::max(2, image.height / 30);
  const int bar_height = 2 * dot;
  const int bar_top = image.height - margin - bar_height;
  fill(image, margin, bar_top, static_cast<int>(std::lround(length_mm / mm_per_pixel)), bar_height);
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g mm", length_mm);
  draw_text(image, text.data(), margin, bar_top - (kGlyphHeight + 2) * dot, dot);
}

}  // namespace osteomill
