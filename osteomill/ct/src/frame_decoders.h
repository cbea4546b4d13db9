#pragma once

#include <span>

namespace osteomill {

/// The size of grey frames, as a DICOM header gives it.
struct FrameSize {
  int columns = 0;
  int rows = 0;
  /// 1, 2 or 4.
  int bytes_a_value = 0;

  std::size_t values() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t bytes() const { return values() * static_cast<std::size_t>(bytes_a_value); }
};

/// These decode what DCMTK does not decode, or not safely: its RLE decoder reads and writes where a damaged
/// header tells it to. One frame each, into `values` with room for `size.bytes()`; false if the stream is
/// damaged, cut short, or of another size.
bool decode_rle(std::span<const unsigned char> stream, const FrameSize& size, std::span<char> values);
bool decode_jpeg2000(std::span<const unsigned char> stream, const FrameSize& size, std::span<char> values);

/// Returns whether a JPEG 2000 stream says that its values have a sign.
bool is_signed_jpeg2000(std::span<const unsigned char> stream);

enum class JpegKind { jpeg, jpeg_ls };
/// Returns whether a stream is of the kind that it is said to be, and has nothing but well-formed segments
/// before a grey image of that size with no more bits than `size` has room for. DCMTK does not check this: it
/// never returns from data that are no segment, or from an image of the other kind.
bool jpeg_fits(std::span<const unsigned char> stream, JpegKind kind, const FrameSize& size);

}  // namespace osteomill
