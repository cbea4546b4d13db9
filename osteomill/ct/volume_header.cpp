#include "osteomill/ct/volume_header.h"

#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "osteomill/ct/inflate.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

std::vector<std::string> check_stored(const std::string& subject, const StoredVoxels& stored) {
  std::error_code error;
  if (!fs::is_regular_file(stored.file, error)) {
    throw InputError(subject, fmt::format("its data file {} is not there", stored.file.string()));
  }
  const std::uint64_t size = fs::file_size(stored.file, error);
  if (error) throw InputError(subject, fmt::format("its data file {} cannot be read", stored.file.string()));
  const std::uint64_t there = size > stored.offset ? size - stored.offset : 0;
  const auto cut_short = [&](std::uint64_t found) {
    return InputError(
        subject, fmt::format("is cut short: its voxels need {} bytes, there are {}", stored.bytes, found));
  };
  std::uint64_t found = there;
  if (stored.compressed) {
    const std::uint64_t needed = stored.bytes + stored.compressed_skip;
    // Somewhat beyond what is needed, so as to come to the checksum.
    const InflatedStream stream = measure_compressed(stored.file, stored.offset, 2 * needed + (1 << 20));
    if (stream.bytes == 0) throw InputError(subject, "its compressed data cannot be decompressed");
    if (stream.bytes < needed) throw cut_short(stream.bytes);
    if (!stream.sound) {
      throw InputError(subject, "its compressed data are cut short or damaged");
    }
    if (stored.compressed_bytes != 0 &&
        (stored.compressed_bytes < stream.compressed_bytes || stored.compressed_bytes > there)) {
      throw InputError(subject, fmt::format("says that its compressed data take {} bytes, they take {}",
                                            stored.compressed_bytes, stream.compressed_bytes));
    }
    found = stream.bytes - stored.compressed_skip;
  }
  if (found < stored.bytes) throw cut_short(found);
  if (found > stored.bytes) return {"holds more data than its sizes need; the rest was left out"};
  return {};
}

std::array<int, 3> checked_dims(const std::string& subject, const std::vector<double>& sizes) {
  if (sizes.size() != 3)
    throw InputError(subject, fmt::format("is not a volume: {} sizes, not 3", sizes.size()));
  std::array<int, 3> dims{};
  double product = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(sizes[axis] >= 1 && sizes[axis] < std::numeric_limits<int>::max() &&
          sizes[axis] == std::floor(sizes[axis]))) {
      throw InputError(subject, fmt::format("has an impossible size: {} voxels along an axis", sizes[axis]));
    }
    dims[axis] = static_cast<int>(sizes[axis]);
    product *= sizes[axis];
  }
  if (product > 1e12) throw InputError(subject, fmt::format("says that it has {:.3g} voxels", product));
  return dims;
}

void check_spacing(const std::string& subject, const std::vector<double>& spacing) {
  if (spacing.size() != 3) {
    throw InputError(subject, fmt::format("has {} spacings, a volume has 3", spacing.size()));
  }
  for (const double distance : spacing) {
    if (!std::isfinite(distance) || distance <= 0) {
      throw InputError(subject, fmt::format("has a spacing of {}, which is no distance", distance));
    }
  }
}

void check_axes(const std::string& subject, const Mat3& axes) {
  constexpr double kTolerance = 1e-3;
  if (!axes.allFinite()) throw InputError(subject, "has axes that are not numbers");
  for (int axis = 0; axis < 3; ++axis) {
    if (axes.col(axis).norm() <= 0) throw InputError(subject, "has an axis of no length");
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 one = axes.col(axis).normalized();
    const Vec3 next = axes.col((axis + 1) % 3).normalized();
    if (std::abs(one.dot(next)) > kTolerance) {
      throw InputError(
          subject, "has axes that are not at right angles (a sheared or flat grid), which is not supported");
    }
  }
}

double millimetres_in(const std::string& subject, std::string_view unit) {
  static const std::map<std::string, double, std::less<>> kUnits{
      {"", 1},           {"mm", 1},         {"millimeter", 1}, {"millimetre", 1},
      {"um", 1e-3},      {"µm", 1e-3},      {"micron", 1e-3},  {"micrometer", 1e-3},
      {"microns", 1e-3}, {"nm", 1e-6},      {"cm", 10},        {"m", 1000},
      {"?", 1},          {"millimeters", 1}};
  const auto found = kUnits.find(unit);
  if (found == kUnits.end())
    throw InputError(subject, fmt::format("has lengths in \"{}\", which is not known", unit));
  return found->second;
}

}  // namespace osteomill
