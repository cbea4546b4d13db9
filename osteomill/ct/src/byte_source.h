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

/// The ways in which the bytes of a file are packed. zlib finds out itself which of the first two it is.
enum class Packing { none, gzip_or_zlib, deflate };

/// A file's bytes in order, unpacked while they are read.
class ByteSource {
 public:
  /// From where `in` stands to the end of its file.
  ByteSource(std::ifstream in, Packing packing);

  /// Fills `bytes` as far as there are any left; returns how many.
  std::size_t read(std::span<char> bytes);
  /// Reads past some bytes; false if there are not as many.
  bool skip(std::uint64_t count);

  bool is_packed() const { return stream_ != nullptr; }
  /// Returns how many bytes the file holds from where the source began, packed as they are.
  std::uint64_t bytes_in_file() const { return in_file_; }
  /// Returns how many bytes of the file, packed as they are, have been read so far.
  std::uint64_t bytes_used() const;
  /// An upper bound on the bytes still to be read: of a packed file what the best packing could hold.
  std::uint64_t max_bytes() const;
  /// Exactly how many bytes there are to be read. For a packed file this unpacks all of it once, and nothing
  /// may have been read before.
  std::uint64_t bytes_to_come();
  /// Returns whether the packed data were read to their proper end, with the right checksums.
  bool ended_well() const { return ended_; }

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

/// Opens a file for reading. Throws InputError naming `subject` if `file` is not there, no regular file (a
/// pipe would wait for ever) or cannot be read.
std::ifstream open_regular_file(const std::string& subject, const std::filesystem::path& file);

}  // namespace osteomill
