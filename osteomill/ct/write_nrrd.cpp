#include "osteomill/ct/write_nrrd.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include <fmt/format.h>
#include <zlib.h>

#include "osteomill/files/atomic_file.h"

namespace osteomill {

namespace {

static_assert(std::endian::native == std::endian::little, "voxels are written as they lie in memory");

constexpr std::size_t kValuesAtOnce = 1 << 16;

// A gzip stream into a file that has begun already.
class GzipWriter {
 public:
  explicit GzipWriter(std::ostream& out) : out_(out) {
    constexpr int kGzip = 15 + 16;
    constexpr int kLevel = 4;  // scans are large, and higher levels win little on noise
    constexpr int kMemory = 9;
    if (deflateInit2(&stream_, kLevel, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~GzipWriter() { deflateEnd(&stream_); }
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  void write(const void* bytes, std::size_t count) { deflate_all(bytes, count, Z_NO_FLUSH); }
  void finish() { deflate_all(nullptr, 0, Z_FINISH); }

 private:
  void deflate_all(const void* bytes, std::size_t count, int flush) {
    stream_.next_in = static_cast<Bytef*>(const_cast<void*>(bytes));
    stream_.avail_in = static_cast<uInt>(count);
    do {
      stream_.next_out = packed_.data();
      stream_.avail_out = static_cast<uInt>(packed_.size());
      deflate(&stream_, flush);
      out_.write(reinterpret_cast<const char*>(packed_.data()),
                 static_cast<std::streamsize>(packed_.size() - stream_.avail_out));
    } while (stream_.avail_out == 0);
  }

  std::ostream& out_;
  z_stream stream_{};
  std::array<Bytef, 1 << 16> packed_;
};

template <typename Stored>
bool holds_exactly(std::span<const float> densities) {
  const auto min = static_cast<float>(std::numeric_limits<Stored>::min());
  const auto max = static_cast<float>(std::numeric_limits<Stored>::max());
  return std::all_of(densities.begin(), densities.end(), [&](float density) {
    return density >= min && density <= max && std::floor(density) == density;
  });
}

template <typename Stored>
void write_values(std::ostream& out, std::span<const float> densities) {
  GzipWriter gzip(out);
  std::vector<Stored> values;
  while (!densities.empty()) {
    const std::span<const float> some = densities.first(std::min(kValuesAtOnce, densities.size()));
    values.assign(some.begin(), some.end());
    gzip.write(values.data(), values.size() * sizeof(Stored));
    densities = densities.subspan(some.size());
  }
  gzip.finish();
}

// As many digits as read back to the same number.
std::string vector_text(const Vec3& v) {
  return fmt::format("({},{},{})", v.x(), v.y(), v.z());
}

std::string header_of(const GridGeometry& geometry, const char* type) {
  std::string directions;
  for (int axis = 0; axis < 3; ++axis) {
    directions += " " + vector_text(geometry.direction.col(axis) * geometry.spacing_mm[axis]);
  }
  return fmt::format(
      "NRRD0004\n"
      "type: {}\n"
      "dimension: 3\n"
      "space: left-posterior-superior\n"
      "sizes: {} {} {}\n"
      "space directions:{}\n"
      "kinds: domain domain domain\n"
      "endian: little\n"
      "encoding: gzip\n"
      "space units: \"mm\" \"mm\" \"mm\"\n"
      "space origin: {}\n\n",
      type, geometry.dims[0], geometry.dims[1], geometry.dims[2], directions,
      vector_text(geometry.origin_mm));
}

}  // namespace

void write_nrrd(const std::filesystem::path& path, const DensityGrid& grid) {
  const std::span<const float> densities = grid.densities();
  const GridGeometry& geometry = grid.geometry();
  write_text_atomically(path, [&](std::ostream& out) {
    if (holds_exactly<std::int16_t>(densities)) {
      out << header_of(geometry, "short");
      write_values<std::int16_t>(out, densities);
    } else if (holds_exactly<std::uint16_t>(densities)) {
      out << header_of(geometry, "ushort");
      write_values<std::uint16_t>(out, densities);
    } else {
      out << header_of(geometry, "float");
      write_values<float>(out, densities);
    }
  });
}

}  // namespace osteomill
