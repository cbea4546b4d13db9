#include "frame_decoders.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>

#include <openjpeg.h>

namespace osteomill {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

namespace {

using Bytes = std::span<const unsigned char>;

// Decodes PackBits (Part 5, G.3.1) into every `step`th of `values` from `first` on. Accepts one trailing
// byte, which makes the length even.
bool unpack_segment(Bytes segment, std::span<char> values, std::size_t first, std::size_t step) {
  std::size_t at = first;
  std::size_t here = 0;
  while (at < values.size()) {
    if (here + 1 >= segment.size()) return false;
    const int code = static_cast<signed char>(segment[here++]);
    if (code == -128) continue;
    const bool repeats = code < 0;
    const auto count = static_cast<std::size_t>(repeats ? 1 - code : code + 1);
    if (at + (count - 1) * step >= values.size() || (!repeats && count > segment.size() - here)) return false;
    for (std::size_t n = 0; n < count; ++n, at += step) {
      values[at] = static_cast<char>(segment[here + (repeats ? 0 : n)]);
    }
    here += repeats ? 1 : count;
  }
  return segment.size() - here <= 1;
}

// Input callbacks for OpenJPEG.
struct Stream {
  Bytes bytes;
  std::size_t here = 0;

  static OPJ_SIZE_T read(void* into, OPJ_SIZE_T count, void* user) {
    auto& self = *static_cast<Stream*>(user);
    count = std::min(count, self.bytes.size() - self.here);
    if (count == 0) return static_cast<OPJ_SIZE_T>(-1);
    std::memcpy(into, self.bytes.data() + self.here, count);
    self.here += count;
    return count;
  }
  static OPJ_BOOL seek(OPJ_OFF_T to, void* user) {
    auto& self = *static_cast<Stream*>(user);
    if (to < 0 || static_cast<std::size_t>(to) > self.bytes.size()) return OPJ_FALSE;
    self.here = static_cast<std::size_t>(to);
    return OPJ_TRUE;
  }
  static OPJ_OFF_T skip(OPJ_OFF_T count, void* user) {
    const auto here = static_cast<OPJ_OFF_T>(static_cast<Stream*>(user)->here);
    return seek(here + count, user) ? count : -1;
  }
};

template <auto destroy>
struct Destroy {
  template <typename Thing>
  void operator()(Thing* thing) const {
    destroy(thing);
  }
};

bool is_grey_of(const opj_image_t& image, const FrameSize& size) {
  const opj_image_comp_t& grey = image.comps[0];
  return image.numcomps == 1 && grey.w == static_cast<OPJ_UINT32>(size.columns) &&
         grey.h == static_cast<OPJ_UINT32>(size.rows) &&
         grey.prec <= static_cast<OPJ_UINT32>(8 * size.bytes_a_value);
}

// SOF0 to SOF15 without DHT, JPG and DAC; SOF55 is JPEG-LS.
bool is_frame_marker(JpegKind kind, int marker) {
  if (kind == JpegKind::jpeg_ls) return marker == 0xF7;
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// Markers with a length: not TEM, RST, SOI, EOI or reserved ones, nor the frame marker of the other kind.
bool is_segment_marker(JpegKind kind, int marker) {
  const JpegKind other = kind == JpegKind::jpeg ? JpegKind::jpeg_ls : JpegKind::jpeg;
  return marker >= 0xC0 && marker < 0xFF && !(marker >= 0xD0 && marker <= 0xD9) &&
         !is_frame_marker(other, marker);
}

}  // namespace

bool decode_rle(Bytes stream, const FrameSize& size, std::span<char> values) {
  // Header (Part 5, G.5): number of segments and their offsets. Each segment holds one byte of every value,
  // the most significant first.
  constexpr std::size_t kHeader = 64;
  const auto number = [&](std::size_t n) {
    return static_cast<std::size_t>(stream[4 * n]) | static_cast<std::size_t>(stream[4 * n + 1]) << 8 |
           static_cast<std::size_t>(stream[4 * n + 2]) << 16 |
           static_cast<std::size_t>(stream[4 * n + 3]) << 24;
  };
  const auto segments = static_cast<std::size_t>(size.bytes_a_value);
  if (stream.size() < kHeader || number(0) != segments) return false;
  for (std::size_t n = 0; n < segments; ++n) {
    const std::size_t start = number(n + 1);
    const std::size_t end = n + 1 < segments ? number(n + 2) : stream.size();
    if (start < kHeader || start > end || end > stream.size()) return false;
    if (!unpack_segment(stream.subspan(start, end - start), values.first(size.bytes()), segments - 1 - n,
                        segments))
      return false;
  }
  return true;
}

bool decode_jpeg2000(Bytes bytes, const FrameSize& size, std::span<char> values) {
  // A bare code stream, as DICOM requires, or one in JP2 boxes.
  constexpr std::array<unsigned char, 4> kBoxes{'j', 'P', ' ', ' '};
  const bool boxed = bytes.size() > 8 && std::equal(kBoxes.begin(), kBoxes.end(), bytes.begin() + 4);
  Stream source{bytes};
  const std::unique_ptr<opj_stream_t, Destroy<opj_stream_destroy>> stream(
      opj_stream_default_create(OPJ_TRUE));
  opj_stream_set_user_data(stream.get(), &source, nullptr);
  opj_stream_set_user_data_length(stream.get(), bytes.size());
  opj_stream_set_read_function(stream.get(), Stream::read);
  opj_stream_set_skip_function(stream.get(), Stream::skip);
  opj_stream_set_seek_function(stream.get(), Stream::seek);
  const std::unique_ptr<opj_codec_t, Destroy<opj_destroy_codec>> codec(
      opj_create_decompress(boxed ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K));
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  if (!opj_setup_decoder(codec.get(), &parameters) || !opj_decoder_set_strict_mode(codec.get(), OPJ_TRUE))
    return false;
  opj_image_t* header = nullptr;
  const bool has_header = opj_read_header(stream.get(), codec.get(), &header);
  const std::unique_ptr<opj_image_t, Destroy<opj_image_destroy>> image(header);
  if (!has_header || !is_grey_of(*image, size) || !opj_decode(codec.get(), stream.get(), image.get()) ||
      !is_grey_of(*image, size) || image->comps[0].data == nullptr)
    return false;
  const auto value_bytes = static_cast<std::size_t>(size.bytes_a_value);
  for (std::size_t n = 0; n < size.values(); ++n) {
    std::memcpy(values.data() + n * value_bytes, image->comps[0].data + n, value_bytes);
  }
  return true;
}

bool is_signed_jpeg2000(Bytes bytes) {
  // The code stream starts with two markers, start and size. The first component's precision, with the sign
  // in the highest bit, follows the sizes and the number of components.
  constexpr std::array<unsigned char, 4> kStart{0xFF, 0x4F, 0xFF, 0x51};
  constexpr std::ptrdiff_t kPrecision = 42;
  const auto start = std::search(bytes.begin(), bytes.end(), kStart.begin(), kStart.end());
  return bytes.end() - start > kPrecision && (start[kPrecision] & 0x80) != 0;
}

bool is_valid_jpeg(Bytes bytes, JpegKind kind, const FrameSize& size) {
  const auto number = [&](std::size_t n) { return bytes[n] << 8 | bytes[n + 1]; };
  if (bytes.size() < 2 || number(0) != 0xFFD8) return false;
  std::size_t here = 2;
  // Segment: FF, marker, length of the rest.
  while (here + 10 <= bytes.size() && bytes[here] == 0xFF) {
    const int marker = bytes[here + 1];
    if (is_frame_marker(kind, marker)) {
      return bytes[here + 4] <= 8 * size.bytes_a_value && number(here + 5) == size.rows &&
             number(here + 7) == size.columns && bytes[here + 9] == 1;
    }
    if (!is_segment_marker(kind, marker) && marker != 0xFF) return false;
    here += marker == 0xFF ? 1 : 2 + static_cast<std::size_t>(number(here + 2));
  }
  return false;
}

}  // namespace osteomill
