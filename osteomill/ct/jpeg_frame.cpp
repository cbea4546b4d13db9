#include "osteomill/ct/jpeg_frame.h"

#include <cstddef>
#include <cstdint>

namespace osteomill {

namespace {

constexpr int kStart = 0xD8;
constexpr int kEnd = 0xD9;
constexpr int kStartOfScan = 0xDA;
constexpr int kJfif = 0xE0;
constexpr std::uint32_t kJfifName = 0x4A464946;
// A JPEG 2000 code stream begins with SOC and SIZ (ISO 15444-1, A.4.1 and A.5.1).
constexpr std::uint32_t kStartAndSize = 0xFF4FFF51;
constexpr std::size_t kLongestBoxes = 1024;

class Bytes {
 public:
  explicit Bytes(std::span<const char> bytes) : bytes_(bytes) {}
  std::size_t size() const { return bytes_.size(); }
  std::uint32_t at(std::size_t offset, std::size_t count) const {
    std::uint32_t number = 0;
    for (std::size_t n = offset; n < offset + count; ++n) {
      number = number << 8 | (n < bytes_.size() ? static_cast<unsigned char>(bytes_[n]) : 0U);
    }
    return number;
  }

 private:
  std::span<const char> bytes_;
};

// SOF0 to SOF15 without DHT, JPG and DAC; SOF55 is JPEG-LS.
bool is_frame(int marker) {
  return (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) ||
         marker == 0xF7;
}

// GDCM asserts that libjpeg has nothing to say about the header: no bytes between segments, a JFIF version 1.
JpegFrame jpeg_frame(const Bytes& bytes) {
  JpegFrame frame{.plain = false};
  std::size_t here = 2;
  while (here + 4 <= bytes.size() && bytes.at(here, 1) == 0xFF) {
    const int marker = static_cast<int>(bytes.at(here + 1, 1));
    const std::size_t body = here + 4;
    if (marker == 0xFF) {
      ++here;
      continue;
    }
    if (marker == kEnd) break;
    if (marker == kStartOfScan) {
      frame.plain = frame.columns > 0;
      break;
    }
    if (marker == kJfif && bytes.at(body, 4) == kJfifName && bytes.at(body + 5, 1) != 1) break;
    if (is_frame(marker)) {
      frame.bits = static_cast<int>(bytes.at(body, 1));
      frame.rows = static_cast<int>(bytes.at(body + 1, 2));
      frame.columns = static_cast<int>(bytes.at(body + 3, 2));
      frame.components = static_cast<int>(bytes.at(body + 5, 1));
    }
    here += 2 + bytes.at(here + 2, 2);
  }
  return frame;
}

JpegFrame jpeg2000_frame(const Bytes& bytes, std::size_t start) {
  // Behind the two markers: length, capabilities, then the sizes.
  const std::size_t body = start + 8;
  const std::uint32_t left = bytes.at(body + 8, 4);
  const std::uint32_t top = bytes.at(body + 12, 4);
  JpegFrame frame;
  frame.columns = static_cast<int>(bytes.at(body, 4) - left);
  frame.rows = static_cast<int>(bytes.at(body + 4, 4) - top);
  frame.components = static_cast<int>(bytes.at(body + 32, 2));
  frame.bits = static_cast<int>(bytes.at(body + 34, 1) & 0x7F) + 1;
  const bool tiled = bytes.at(body + 24, 4) != 0 || bytes.at(body + 28, 4) != 0;
  frame.plain = left == 0 && top == 0 && !tiled && bytes.at(body + 35, 1) == 1 && bytes.at(body + 36, 1) == 1;
  return frame;
}

}  // namespace

std::optional<JpegFrame> find_jpeg_frame(std::span<const char> stream) {
  const Bytes bytes(stream);
  if (bytes.at(0, 1) == 0xFF && bytes.at(1, 1) == kStart) return jpeg_frame(bytes);
  // JPEG 2000 may have boxes around it.
  for (std::size_t start = 0; start + 8 <= bytes.size() && start < kLongestBoxes; ++start) {
    if (bytes.at(start, 4) == kStartAndSize) return jpeg2000_frame(bytes, start);
  }
  return std::nullopt;
}

}  // namespace osteomill
