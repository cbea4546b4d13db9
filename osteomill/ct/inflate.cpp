#include "osteomill/ct/inflate.h"

#include <array>
#include <fstream>
#include <vector>

#include <zlib.h>

namespace osteomill {

namespace {

constexpr int kRawDeflate = -15;
// zlib finds out itself which of the two it is.
constexpr int kGzipOrZlib = 15 + 32;

// The first byte of a gzip member.
constexpr Bytef kGzipMagic = 0x1F;

class Inflater {
 public:
  explicit Inflater(int window_bits) { ready_ = inflateInit2(&stream_, window_bits) == Z_OK; }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  bool ready() const { return ready_; }
  z_stream& stream() { return stream_; }

 private:
  z_stream stream_{};
  bool ready_ = false;
};

}  // namespace

std::optional<std::string> inflate_raw(std::string_view deflated, std::uint64_t at_most) {
  Inflater inflater(kRawDeflate);
  if (!inflater.ready()) return std::nullopt;
  z_stream& stream = inflater.stream();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(deflated.data()));
  stream.avail_in = static_cast<uInt>(deflated.size());
  std::string inflated;
  std::vector<char> block(1 << 18);
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    state = inflate(&stream, Z_NO_FLUSH);
    inflated.append(block.data(), block.size() - stream.avail_out);
    if (inflated.size() > at_most) return std::nullopt;
  }
  if (state != Z_STREAM_END) return std::nullopt;
  return inflated;
}

InflatedStream measure_compressed(const std::filesystem::path& path, std::uint64_t offset,
                                  std::uint64_t at_most) {
  InflatedStream result;
  Inflater inflater(kGzipOrZlib);
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  if (!in || !inflater.ready()) return result;
  z_stream& stream = inflater.stream();
  std::vector<char> input(1 << 16);
  std::vector<char> output(1 << 18);
  int state = Z_OK;
  while (state == Z_OK || state == Z_BUF_ERROR) {
    if (stream.avail_in == 0) {
      in.read(input.data(), static_cast<std::streamsize>(input.size()));
      stream.next_in = reinterpret_cast<Bytef*>(input.data());
      stream.avail_in = static_cast<uInt>(in.gcount());
      result.compressed_bytes += stream.avail_in;
      if (stream.avail_in == 0) return result;
    }
    stream.next_out = reinterpret_cast<Bytef*>(output.data());
    stream.avail_out = static_cast<uInt>(output.size());
    state = inflate(&stream, Z_NO_FLUSH);
    result.bytes += output.size() - stream.avail_out;
    if (result.bytes > at_most) return result;
    // Another gzip member may follow the first.
    if (state == Z_STREAM_END && stream.avail_in > 0 && *stream.next_in == kGzipMagic) {
      state = inflateReset(&stream);
    }
  }
  result.compressed_bytes -= stream.avail_in;
  result.sound = state == Z_STREAM_END;
  return result;
}

}  // namespace osteomill
