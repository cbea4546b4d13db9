#include "byte_source.h"

#include <algorithm>

#include <fmt/format.h>
#include <zlib.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/input_files.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Window bits of inflateInit2.
constexpr int kRawDeflate = -15;
constexpr int kGzipOrZlib = 15 + 32;

// Deflate's maximum compression ratio (zlib manual, "Maximum Compression Factor").
constexpr std::uint64_t kMaxRatio = 1032;

// First byte of a gzip member.
constexpr Bytef kGzipMagic = 0x1F;

}  // namespace

void ByteSource::EndInflate::operator()(z_stream_s* stream) const {
  inflateEnd(stream);
  delete stream;
}

ByteSource::ByteSource(std::ifstream in, Packing packing) : in_(std::move(in)) {
  in_.clear();
  const std::streamoff here = in_.tellg();
  in_.seekg(0, std::ios::end);
  in_file_ = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in_.tellg() - here));
  in_.seekg(here);
  if (packing == Packing::none) return;
  stream_.reset(new z_stream_s{});
  if (inflateInit2(stream_.get(), packing == Packing::deflate ? kRawDeflate : kGzipOrZlib) != Z_OK) {
    throw std::bad_alloc();
  }
  input_.resize(1 << 16);
}

std::uint64_t ByteSource::max_bytes() const {
  return is_packed() ? kMaxRatio * in_file_ : in_file_ - std::min(in_file_, used_);
}

std::uint64_t ByteSource::compressed_bytes_read() const {
  return used_ - (is_packed() ? stream_->avail_in : 0);
}

std::uint64_t ByteSource::count_remaining_bytes() {
  if (!is_packed()) return max_bytes();
  const std::streamoff start = in_.tellg();
  std::vector<char> block(1 << 18);
  std::uint64_t total = 0;
  for (std::size_t count = block.size(); count == block.size();) total += count = read(block);
  in_.clear();
  in_.seekg(start);
  inflateReset(stream_.get());
  stream_->avail_in = 0;
  used_ = 0;
  ended_ = damaged_ = false;
  return total;
}

void ByteSource::refill() {
  if (stream_->avail_in > 0) return;
  in_.read(input_.data(), static_cast<std::streamsize>(input_.size()));
  stream_->next_in = reinterpret_cast<Bytef*>(input_.data());
  stream_->avail_in = static_cast<uInt>(in_.gcount());
  used_ += stream_->avail_in;
}

std::size_t ByteSource::read(std::span<char> bytes) {
  if (!is_packed()) {
    in_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    used_ += static_cast<std::uint64_t>(in_.gcount());
    return static_cast<std::size_t>(in_.gcount());
  }
  stream_->next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream_->avail_out = static_cast<uInt>(bytes.size());
  while (stream_->avail_out > 0 && !ended_ && !damaged_) {
    refill();
    const int state = stream_->avail_in == 0 ? Z_DATA_ERROR : inflate(stream_.get(), Z_NO_FLUSH);
    if (state == Z_STREAM_END) {
      refill();
      // Another gzip member may follow the first.
      ended_ = stream_->avail_in == 0 || *stream_->next_in != kGzipMagic;
      if (!ended_) inflateReset(stream_.get());
    } else {
      damaged_ = state != Z_OK;
    }
  }
  return bytes.size() - stream_->avail_out;
}

bool ByteSource::skip(std::uint64_t count) {
  if (!is_packed()) {
    in_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
    used_ += count;
    return static_cast<bool>(in_);
  }
  std::vector<char> skipped(1 << 16);
  while (count > 0) {
    const std::size_t wanted = std::min<std::uint64_t>(count, skipped.size());
    if (read(std::span(skipped).first(wanted)) != wanted) return false;
    count -= wanted;
  }
  return true;
}

std::ifstream open_regular_file(const std::string& subject, const fs::path& file) {
  std::error_code error;
  const std::string name = file.string() == subject ? "" : fmt::format("its data file {} ", file.string());
  if (!fs::exists(file, error)) throw InputError(subject, name + "does not exist");
  if (!fs::is_regular_file(file, error)) throw InputError(subject, name + "is not a regular file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(subject, name + "cannot be read");
  register_input(file);
  return in;
}

}  // namespace osteomill
