#include "osteomill/recording/recording_checksum.h"

#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kStart = "osteomill recording; HDF5 follows after 512 bytes, their crc32: ";

// From where the stream stands to the end of the file.
unsigned long crc32_of_rest(std::istream& in) {
  std::vector<char> buffer(1 << 20);
  unsigned long crc = ::crc32(0, nullptr, 0);
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), in.gcount() > 0) {
    crc = ::crc32(crc, reinterpret_cast<const Bytef*>(buffer.data()), static_cast<uInt>(in.gcount()));
  }
  return crc;
}

std::string seal_line(unsigned long crc) {
  return fmt::format("{}{:08x}\n", kStart, crc);
}

}  // namespace

void write_checksum(const fs::path& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(kUserBlockBytes);
  const std::string line = seal_line(crc32_of_rest(file));
  file.clear();
  file.seekp(0);
  file << line;
  file.close();
  if (!file) throw InputError(path.string(), "cannot be written to its end (is the disk full?)");
}

Checksum check_checksum(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string(), "cannot be read");
  std::string block(kUserBlockBytes, '\0');
  if (!in.read(block.data(), kUserBlockBytes) || !block.starts_with(kStart)) return Checksum::none;
  const std::string line = seal_line(crc32_of_rest(in));
  return block.starts_with(line) ? Checksum::intact : Checksum::broken;
}

}  // namespace osteomill
