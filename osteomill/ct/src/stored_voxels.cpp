#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "header_text.h"
#include "plausible_scan.h"
#include "volume_file.h"

namespace osteomill {

namespace {

constexpr std::size_t kBlock = 1 << 18;
// Maximum length of a number with its separator; limits the text that is read.
constexpr std::uint64_t kMaxLetters = 64;
// Bytes read beyond the voxels to reach the checksum.
constexpr std::uint64_t kMaxRest = 1 << 20;
constexpr const char* kHoldsMore = "holds more data than its sizes need; the rest was ignored";

// Calls `use` with a value of the voxel type.
template <typename Use>
auto with_type(VoxelType type, const Use& use) {
  switch (type) {
    case VoxelType::int8:
      return use(std::int8_t{});
    case VoxelType::uint8:
      return use(std::uint8_t{});
    case VoxelType::int16:
      return use(std::int16_t{});
    case VoxelType::uint16:
      return use(std::uint16_t{});
    case VoxelType::int32:
      return use(std::int32_t{});
    case VoxelType::uint32:
      return use(std::uint32_t{});
    case VoxelType::int64:
      return use(std::int64_t{});
    case VoxelType::uint64:
      return use(std::uint64_t{});
    case VoxelType::float32:
      return use(float{});
    default:
      return use(double{});
  }
}

// Returns whether a voxel of this type can represent the number.
bool fits(double number, VoxelType type) {
  return with_type(type, [&](auto value) {
    using Limits = std::numeric_limits<decltype(value)>;
    return !Limits::is_integer ||
           (std::floor(number) == number && number >= static_cast<double>(Limits::lowest()) &&
            number <= static_cast<double>(Limits::max()));
  });
}

InputError truncation_error(const std::string& subject, std::uint64_t needed, std::uint64_t found) {
  return {subject, fmt::format("is cut short: its voxels need {} bytes, it has {}", needed, found)};
}

// Appends densities. `bytes` must hold whole values; swaps them in place if their byte order is not native.
void append(std::span<char> bytes, const StoredVoxels& stored, std::vector<float>& densities) {
  with_type(stored.type, [&](auto value) {
    const bool swap = stored.big_endian != (std::endian::native == std::endian::big);
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(value)) {
      char* const first = bytes.data() + at;
      if (swap) std::reverse(first, first + sizeof(value));
      std::memcpy(&value, first, sizeof(value));
      densities.push_back(static_cast<float>(stored.slope * static_cast<double>(value) + stored.intercept));
    }
  });
}

// Checks the data after the voxels; usually there are none.
void check_rest(const std::string& subject, StoredVoxels& stored, std::uint64_t needed,
                std::vector<std::string>& warnings) {
  ByteSource& source = stored.source;
  std::vector<char> block(kBlock);
  std::uint64_t rest = 0;
  std::size_t count = block.size();
  while (count == block.size() && rest < needed + kMaxRest) rest += count = source.read(block);
  if (source.is_packed()) {
    if (!source.has_ended_intact()) throw InputError(subject, "its compressed data are cut short or damaged");
    const std::uint64_t said = stored.compressed_bytes;
    if (said != 0 && (said < source.compressed_bytes_read() || said > source.bytes_in_file())) {
      throw InputError(subject, fmt::format("states {} bytes of compressed data but has {}", said,
                                            source.compressed_bytes_read()));
    }
  }
  if (rest > 0) warnings.push_back(kHoldsMore);
}

// Appends `count` densities of a total of `all`.
void read_binary(const std::string& subject, StoredVoxels& stored, std::uint64_t count, std::uint64_t all,
                 std::uint64_t max_bytes, std::vector<float>& densities, std::vector<std::string>& warnings) {
  ByteSource& source = stored.source;
  const std::uint64_t size = bytes_of(stored.type), needed = count * size;
  const std::uint64_t possible = source.max_bytes();
  if (possible < stored.skip + needed) {
    throw truncation_error(subject, needed, possible - std::min(possible, stored.skip));
  }
  check_memory(subject, all, max_bytes);
  if (!source.skip(stored.skip)) throw InputError(subject, "its compressed data cannot be decompressed");
  densities.reserve(all);
  std::vector<char> block(kBlock);
  for (std::uint64_t found = 0; found < needed;) {
    const std::span<char> wanted(block.data(), std::min<std::uint64_t>(kBlock, needed - found));
    const std::size_t here = source.read(wanted);
    found += here;
    if (found == 0) throw InputError(subject, "its compressed data cannot be decompressed");
    if (here < wanted.size()) throw truncation_error(subject, needed, found);
    append(wanted, stored, densities);
    WorkProgress::done(densities.size() * size, all * size);
  }
  check_rest(subject, stored, needed, warnings);
}

void read_text(const std::string& subject, StoredVoxels& stored, std::uint64_t count, std::uint64_t all,
               std::uint64_t max_bytes, std::vector<float>& densities, std::vector<std::string>& warnings) {
  stored.source.skip(stored.skip);
  // At least one digit and one separator each.
  const std::uint64_t needed = 2 * count - 1;
  const std::uint64_t possible = stored.source.max_bytes();
  if (possible < needed) throw truncation_error(subject, needed, possible);
  check_memory(subject, all, max_bytes);
  std::string text;
  std::vector<char> block(kBlock);
  for (std::size_t here = kBlock; here == kBlock && text.size() < kMaxLetters * count + kBlock;) {
    here = stored.source.read(block);
    text.append(block.data(), here);
  }
  const std::optional<std::vector<double>> numbers = parse_numbers(text);
  if (!numbers) throw InputError(subject, "holds text between its voxels that is not a number");
  if (numbers->size() < count) {
    throw InputError(
        subject, fmt::format("is cut short: it needs {} voxels but has {} numbers", count, numbers->size()));
  }
  if (numbers->size() > count) warnings.push_back(kHoldsMore);
  for (const double number : *numbers) {
    if (!fits(number, stored.type))
      throw InputError(subject, fmt::format("holds {}, which its voxel type cannot hold", number));
  }
  densities.insert(densities.end(), numbers->begin(), numbers->begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

std::uint64_t bytes_of(VoxelType type) {
  return with_type(type, [](auto value) { return std::uint64_t{sizeof(value)}; });
}

ByteSource source_behind(std::ifstream in, const BeforeVoxels& before, Packing packing) {
  for (double n = 0; n < before.lines && in; ++n)
    in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  if (before.file_bytes > 0) in.seekg(static_cast<std::streamoff>(before.file_bytes));
  return {std::move(in), packing};
}

void set_skip(StoredVoxels& stored, std::uint64_t count) {
  stored.skip = stored.before.bytes;
  if (!stored.before.are_last) return;
  const std::uint64_t there = stored.source.count_remaining_bytes();
  stored.skip = there - std::min(there, count * bytes_of(stored.type));
}

std::vector<float> read_voxels(const std::string& subject, StoredVoxels& stored, std::uint64_t count,
                               std::uint64_t max_bytes, std::vector<std::string>& warnings) {
  const std::size_t files = 1 + stored.more.size();
  if (count % files != 0) {
    throw InputError(
        subject,
        fmt::format("has {} voxels in {} files, which cannot be the same number in each", count, files));
  }
  std::vector<float> densities;
  std::vector<std::string> found;
  const auto read = [&] {
    (stored.is_text ? read_text : read_binary)(subject, stored, count / files, count, max_bytes, densities,
                                               found);
  };
  read();
  const Packing packing = stored.source.is_packed() ? Packing::gzip_or_zlib : Packing::none;
  for (const std::filesystem::path& path : stored.more) {
    stored.source = source_behind(open_regular_file(subject, path), stored.before, packing);
    set_skip(stored, count / files);
    read();
  }
  // All files give the same warning, so report it once.
  if (!found.empty()) warnings.push_back(found.front());
  return densities;
}

}  // namespace osteomill
