#include "osteomill/ct/write_nrrd.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"

namespace osteomill {

namespace {

static_assert(std::endian::native == std::endian::little, "voxels are written as they lie in memory");

template <typename Stored>
bool holds_exactly(const DensityGrid& grid) {
  const auto min = static_cast<float>(std::numeric_limits<Stored>::min());
  const auto max = static_cast<float>(std::numeric_limits<Stored>::max());
  bool holds = true;
  for_each_row(grid, [&](std::span<const float> row) {
    holds = holds && std::all_of(row.begin(), row.end(), [&](float density) {
              return density >= min && density <= max && std::floor(density) == density;
            });
  });
  return holds;
}

// Returns false if not everything could be written.
template <typename Stored>
bool write_values(gzFile file, const DensityGrid& grid) {
  std::vector<Stored> values;
  bool written = true;
  for_each_row(grid, [&](std::span<const float> row) {
    values.assign(row.begin(), row.end());
    const auto bytes = static_cast<unsigned>(values.size() * sizeof(Stored));
    written = written && gzwrite(file, values.data(), bytes) == static_cast<int>(bytes);
  });
  return written;
}

// Writes the shortest digits that read back to the same number.
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

// Writes the header, then the values as a gzip stream.
template <typename Stored>
void write_as(const char* type, const DensityGrid& grid, const std::filesystem::path& path,
              const std::filesystem::path& beside) {
  errno = 0;
  std::ofstream header(beside);
  header << header_of(grid.geometry(), type);
  header.close();
  // Scans are large and noisy: levels above 4 gain little.
  gzFile file = header ? gzopen(beside.c_str(), "ab4") : nullptr;
  if (file == nullptr) throw InputError(path.string(), with_reason("cannot be created"));
  const bool written = write_values<Stored>(file, grid);
  if (gzclose(file) != Z_OK || !written)
    throw InputError(path.string(), with_reason("cannot be written completely"));
}

}  // namespace

void write_nrrd(const std::filesystem::path& path, const DensityGrid& grid) {
  write_file_atomically(path, [&](const std::filesystem::path& beside) {
    if (holds_exactly<std::int16_t>(grid)) {
      write_as<std::int16_t>("short", grid, path, beside);
    } else if (holds_exactly<std::uint16_t>(grid)) {
      write_as<std::uint16_t>("ushort", grid, path, beside);
    } else {
      write_as<float>("float", grid, path, beside);
    }
  });
}

}  // namespace osteomill
