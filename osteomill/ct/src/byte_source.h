#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct z_stream_s;

namespace osteomill {

/// Compression of a file's bytes. zlib detects itself whether data are gzip or zlib.
enum class Packing { none, gzip_or_zlib, deflate };

/// Sequential reader of a file's bytes that decompresses on the fly.
class ByteSource {
 public:
  /// Reads from the current position of `in` to the end of the file.
  ByteSource(std::ifstream in, Packing packing);

  /// Reads up to `bytes.size()` bytes; returns the number read, which is less only at the end or if data are
  /// damaged.
  std::size_t read(std::span<char> bytes);
  /// Skips `count` bytes. Returns false if a compressed source has fewer.
  bool skip(std::uint64_t count);

  bool is_packed() const { return stream_ != nullptr; }
  /// Returns the number of bytes of the file from the source's start on, still compressed.
  std::uint64_t bytes_in_file() const { return in_file_; }
  /// Returns the number of bytes of the file read so far, still compressed.
  std::uint64_t compressed_bytes_read() const;
  /// Returns an upper bound on the bytes still to be read; for a compressed file, by the maximum compression
  /// ratio.
  std::uint64_t max_bytes() const;
  /// Returns the exact number of bytes still to be read. Decompresses a compressed file once, of which
  /// nothing may have been read before.
  std::uint64_t count_remaining_bytes();
  /// Returns whether the compressed data were read to their end and their checksums match.
  bool has_ended_intact() const { return ended_; }

 private:
  struct EndInflate {
    void operator()(z_stream_s* stream) const;
  };

  void refill();

  std::ifstream in_;
  std::uint64_t in_file_ = 0;
  std::unique_ptr<z_stream_s, EndInflate> stream_;
  std::vector<char> input_;
  std::uint64_t used_ = 0;
  bool ended_ = false;
  bool damaged_ = false;
};

/// Opens a file for reading. Throws InputError, naming `subject`, if `file` is missing, not a regular file (a
/// pipe could block forever) or unreadable.
std::ifstream open_regular_file(const std::string& subject, const std::filesystem::path& file);

}  // namespace osteomill
