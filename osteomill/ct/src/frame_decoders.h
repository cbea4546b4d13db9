#pragma once

#include <span>

namespace osteomill {

/// Size of grey frames according to a DICOM header.
struct FrameSize {
  int columns = 0;
  int rows = 0;
  /// 1, 2 or 4.
  int bytes_a_value = 0;

  std::size_t values() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t bytes() const { return values() * static_cast<std::size_t>(bytes_a_value); }
};

/// Decoders that DCMTK lacks or whose DCMTK version is unsafe: its RLE decoder accesses memory out of bounds
/// if the header is damaged. Each decodes one frame into `values`, which must have room for `size.bytes()`;
/// returns false if the stream is damaged, cut short or of another size.
bool decode_rle(std::span<const unsigned char> stream, const FrameSize& size, std::span<char> values);
bool decode_jpeg2000(std::span<const unsigned char> stream, const FrameSize& size, std::span<char> values);

/// Returns whether the header of a JPEG 2000 stream declares signed values.
bool is_signed_jpeg2000(std::span<const unsigned char> stream);

enum class JpegKind { jpeg, jpeg_ls };
/// Returns whether a stream is of this kind and has only well-formed segments before a grey image of this
/// size, with no more bits than `size` allows. DCMTK does not check this: it hangs on data that are not a
/// segment and on an image of the other kind.
bool is_valid_jpeg(std::span<const unsigned char> stream, JpegKind kind, const FrameSize& size);

}  // namespace osteomill
