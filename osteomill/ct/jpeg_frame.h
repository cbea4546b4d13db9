#pragma once

#include <optional>
#include <span>

namespace osteomill {

/// What a JPEG, JPEG-LS or JPEG 2000 stream says of the image in it.
struct JpegFrame {
  int columns = 0;
  int rows = 0;
  int components = 0;
  int bits = 0;
  /// The header is sound, every component has a sample for every pixel, the image begins where the stream's
  /// grid does.
  bool plain = true;
};

/// Finds the frame header; nothing where the stream does not begin like JPEG. The decoders trust it, so it
/// has to agree with what the file around it says before they get it.
std::optional<JpegFrame> find_jpeg_frame(std::span<const char> stream);

}  // namespace osteomill
