#include "frame_decoders.h"

#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/generated_dicom.h"

namespace osteomill {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr FrameSize kSize{.columns = 7, .rows = 5, .bytes_a_value = 2};

std::int16_t value_at(std::size_t n) {
  return static_cast<std::int16_t>(300 * static_cast<int>(n) - 1000);
}

void expect_values(const std::vector<char>& values) {
  for (std::size_t n = 0; n < kSize.values(); ++n) {
    std::int16_t value = 0;
    std::memcpy(&value, values.data() + 2 * n, 2);
    EXPECT_EQ(value, value_at(n)) << n;
  }
}

void put(Bytes& bytes, std::size_t at, std::uint32_t number) {
  for (std::size_t n = 0; n < 4; ++n) bytes[at + n] = static_cast<unsigned char>(number >> 8 * n);
}

// Two segments, high and low bytes, each a literal run.
Bytes rle_stream() {
  Bytes stream(64);
  put(stream, 0, 2);
  for (const unsigned shift : {8U, 0U}) {
    put(stream, shift == 8 ? 4 : 8, static_cast<std::uint32_t>(stream.size()));
    stream.push_back(static_cast<unsigned char>(kSize.values() - 1));
    for (std::size_t n = 0; n < kSize.values(); ++n) {
      stream.push_back(static_cast<unsigned char>(static_cast<std::uint16_t>(value_at(n)) >> shift));
    }
  }
  return stream;
}

bool decodes_rle(const Bytes& stream, std::vector<char>& values) {
  values.assign(kSize.bytes(), 0);
  return decode_rle(stream, kSize, values);
}

TEST(FrameDecoders, RleYieldsTheEncodedValues) {
  std::vector<char> values;
  ASSERT_TRUE(decodes_rle(rle_stream(), values));
  expect_values(values);
}

// Example from the PackBits documentation: fe aa (three times), 02 80 00 2a, fd aa (four times), 80 (no-op),
// 00 22.
TEST(FrameDecoders, RleUnpacksRunsAndLiterals) {
  Bytes stream(64);
  put(stream, 0, 1);
  put(stream, 4, 64);
  const Bytes packed{0xFE, 0xAA, 0x02, 0x80, 0x00, 0x2A, 0xFD, 0xAA, 0x80, 0x00, 0x22, 0x00};
  stream.insert(stream.end(), packed.begin(), packed.end());
  std::vector<char> values(11);
  ASSERT_TRUE(decode_rle(stream, {.columns = 11, .rows = 1, .bytes_a_value = 1}, values));
  const Bytes expected{0xAA, 0xAA, 0xAA, 0x80, 0x00, 0x2A, 0xAA, 0xAA, 0xAA, 0xAA, 0x22};
  EXPECT_EQ(std::memcmp(values.data(), expected.data(), expected.size()), 0);
  // Run beyond the end of the frame.
  EXPECT_FALSE(decode_rle(stream, {.columns = 9, .rows = 1, .bytes_a_value = 1}, values));
}

TEST(FrameDecoders, RefusesDamagedRle) {
  std::vector<char> values;
  for (const std::uint32_t bad : {0U, 1U, 3U, 14U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    Bytes stream = rle_stream();
    put(stream, 0, bad);
    EXPECT_FALSE(decodes_rle(stream, values)) << bad;
  }
  for (const std::size_t offset : {4U, 8U}) {
    for (const std::uint32_t bad : {0U, 63U, 65U, 5000U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
      Bytes stream = rle_stream();
      put(stream, offset, bad);
      EXPECT_FALSE(decodes_rle(stream, values)) << offset << " " << bad;
    }
  }
  const Bytes whole = rle_stream();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(decodes_rle({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}, values));
  }
}

Bytes jpeg2000_of_values() {
  std::vector<int> values;
  for (std::size_t n = 0; n < kSize.values(); ++n) values.push_back(value_at(n));
  return testing_support::jpeg2000_stream(values, kSize.columns, kSize.rows, 16, true);
}

TEST(FrameDecoders, Jpeg2000YieldsTheEncodedValues) {
  std::vector<char> values(kSize.bytes());
  ASSERT_TRUE(decode_jpeg2000(jpeg2000_of_values(), kSize, values));
  expect_values(values);
}

TEST(FrameDecoders, RefusesJpeg2000OfAnotherSizeOrTruncated) {
  const Bytes whole = jpeg2000_of_values();
  for (const FrameSize& size : {FrameSize{5, 7, 2}, {7, 6, 2}, {7, 5, 1}}) {
    std::vector<char> values(size.bytes());
    EXPECT_FALSE(decode_jpeg2000(whole, size, values));
  }
  std::vector<char> values(kSize.bytes());
  // The last two bytes are only the end marker.
  for (std::size_t length = 0; length + 2 < whole.size(); ++length) {
    EXPECT_FALSE(decode_jpeg2000(std::span(whole).first(length), kSize, values)) << length;
  }
}

TEST(FrameDecoders, RefusesMismatchedOrDamagedJpegHeaders) {
  // SOI, a comment, SOF3 (lossless): 16 bits, 5 rows, 7 columns, one component.
  const Bytes jpeg{0xFF, 0xD8, 0xFF, 0xFE, 0x00, 0x04, 0x20, 0x20, 0xFF, 0xC3, 0x00,
                   0x0B, 0x10, 0x00, 0x05, 0x00, 0x07, 0x01, 0x01, 0x11, 0x00};
  EXPECT_TRUE(is_valid_jpeg(jpeg, JpegKind::jpeg, kSize));
  EXPECT_FALSE(is_valid_jpeg(jpeg, JpegKind::jpeg, {.columns = 5, .rows = 7, .bytes_a_value = 2}));
  EXPECT_FALSE(is_valid_jpeg(jpeg, JpegKind::jpeg, {.columns = 7, .rows = 5, .bytes_a_value = 1}));
  Bytes colour = jpeg;
  colour[17] = 3;
  EXPECT_FALSE(is_valid_jpeg(colour, JpegKind::jpeg, kSize));
  for (std::size_t length = 2; length < 18; ++length) {
    EXPECT_FALSE(is_valid_jpeg(std::span(jpeg).first(length), JpegKind::jpeg, kSize)) << length;
  }
  EXPECT_FALSE(is_valid_jpeg(Bytes{1, 2, 3}, JpegKind::jpeg, kSize)) << "not JPEG";
  Bytes no_start = jpeg;
  no_start[1] = 0x01;
  EXPECT_FALSE(is_valid_jpeg(no_start, JpegKind::jpeg, kSize));
  for (const unsigned char lone : Bytes{0x01, 0x02, 0xD0, 0xD8, 0xD9}) {
    Bytes other = jpeg;
    other[3] = lone;
    EXPECT_FALSE(is_valid_jpeg(other, JpegKind::jpeg, kSize)) << "a marker that begins no segment";
  }
  // DCMTK would search endlessly after an image of the other kind.
  EXPECT_FALSE(is_valid_jpeg(jpeg, JpegKind::jpeg_ls, kSize));
  Bytes jpeg_ls = jpeg;
  jpeg_ls[9] = 0xF7;
  EXPECT_TRUE(is_valid_jpeg(jpeg_ls, JpegKind::jpeg_ls, kSize));
  EXPECT_FALSE(is_valid_jpeg(jpeg_ls, JpegKind::jpeg, kSize));
}

}  // namespace
}  // namespace osteomill
