// NIfTI-1, https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "volume_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeaderBytes = 348;
constexpr double kAgreement = 1e-3;

// The header's bytes; numbers are fetched by their offset in nifti1.h.
class Bytes {
 public:
  explicit Bytes(const std::array<char, kHeaderBytes>& bytes) : bytes_(bytes) {}
  void swap_order() { swap_ = !swap_; }
  bool is_big_endian() const { return swap_ != (std::endian::native == std::endian::big); }

  template <typename Number>
  Number at(std::size_t offset) const {
    std::array<char, sizeof(Number)> raw{};
    for (std::size_t n = 0; n < sizeof(Number); ++n) {
      raw[swap_ ? sizeof(Number) - 1 - n : n] = bytes_[offset + n];
    }
    return std::bit_cast<Number>(raw);
  }
  double number(std::size_t offset) const { return static_cast<double>(at<float>(offset)); }
  int whole(std::size_t offset) const { return at<std::int16_t>(offset); }
  std::string_view text(std::size_t offset, std::size_t length) const {
    return {bytes_.data() + offset, length};
  }

 private:
  std::array<char, kHeaderBytes> bytes_;
  bool swap_ = false;
};

// The file's bytes, whether it is compressed or not.
ByteSource open_source(const std::string& subject, const fs::path& path) {
  std::ifstream in = open_regular_file(subject, path);
  const bool packed = in.get() == 0x1F && in.get() == 0x8B;
  in.clear();
  in.seekg(0);
  return {std::move(in), packed ? Packing::gzip_or_zlib : Packing::none};
}

Bytes read_header(const std::string& subject, ByteSource& source) {
  std::array<char, kHeaderBytes> bytes{};
  if (source.read(bytes) != kHeaderBytes) throw InputError(subject, "is cut short in its header");
  Bytes header(bytes);
  if (header.at<std::int32_t>(0) != static_cast<std::int32_t>(kHeaderBytes)) header.swap_order();
  if (header.at<std::int32_t>(0) != static_cast<std::int32_t>(kHeaderBytes)) {
    throw InputError(subject, "is not NIfTI-1: its header does not have 348 bytes");
  }
  if (header.text(344, 3) != "n+1")
    throw InputError(subject, "is not NIfTI-1 in one file: its magic is not n+1");
  return header;
}

std::vector<double> sizes_of(const std::string& subject, const Bytes& header) {
  const int dimensions = header.whole(40);
  if (dimensions < 3 || dimensions > 7) {
    throw InputError(subject, fmt::format("is not a volume: it has {} dimensions", dimensions));
  }
  for (int axis = 4; axis <= dimensions; ++axis) {
    const int size = header.whole(40 + 2 * static_cast<std::size_t>(axis));
    if (size > 1) throw InputError(subject, fmt::format("holds {} volumes or values a voxel, not one", size));
  }
  return {static_cast<double>(header.whole(42)), static_cast<double>(header.whole(44)),
          static_cast<double>(header.whole(46))};
}

VoxelType type_of(const std::string& subject, const Bytes& header) {
  using enum VoxelType;
  static const std::map<int, VoxelType> kTypes{{2, uint8},    {4, int16},    {8, int32},    {16, float32},
                                               {64, float64}, {256, int8},   {512, uint16}, {768, uint32},
                                               {1024, int64}, {1280, uint64}};
  const int type = header.whole(70);
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) {
    throw InputError(subject, fmt::format("has voxels of type {}, which is not grey or not supported", type));
  }
  return found->second;
}

double unit_of(const std::string& subject, const Bytes& header) {
  switch (header.at<std::int8_t>(123) & 7) {
    case 0:
    case 2:
      return 1;
    case 1:
      return 1000;
    case 3:
      return 1e-3;
    default:
      throw InputError(subject, "has lengths in a unit that is not known");
  }
}

// Columns: the steps from voxel to voxel, and the place of the first, in RAS.
struct Placement {
  Mat3 steps;
  Vec3 origin;
};

Placement by_sform(const Bytes& header) {
  Placement placement;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double value =
          header.number(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(column));
      (column < 3 ? placement.steps(row, column) : placement.origin[row]) = value;
    }
  }
  return placement;
}

Placement by_qform(const std::string& subject, const Bytes& header, const Vec3& spacing) {
  const Vec3 bcd(header.number(256), header.number(260), header.number(264));
  if (!(bcd.norm() < 1.01)) throw InputError(subject, "has a qform that is no rotation");
  const Quat rotation(std::sqrt(std::max(0.0, 1 - bcd.squaredNorm())), bcd.x(), bcd.y(), bcd.z());
  const double qfac = header.number(76) < 0 ? -1 : 1;
  return {rotation.normalized().toRotationMatrix() *
              Vec3(spacing.x(), spacing.y(), qfac * spacing.z()).asDiagonal(),
          Vec3(header.number(268), header.number(272), header.number(276))};
}

Placement placement_of(const std::string& subject, const Bytes& header, const Vec3& spacing,
                       std::vector<std::string>& warnings) {
  if (header.whole(254) > 0) return by_sform(header);
  if (header.whole(252) > 0) return by_qform(subject, header, spacing);
  warnings.push_back("does not say how it lies in the patient; its axes were taken for RAS");
  return {spacing.asDiagonal(), Vec3::Zero()};
}

// Checks that two statements of a header agree.
void check_agreement(const std::string& subject, const Bytes& header, const Placement& placement,
                     const Vec3& spacing, std::vector<std::string>& warnings) {
  const Vec3 lengths = placement.steps.colwise().norm();
  if (((lengths - spacing).cwiseAbs().array() > kAgreement * spacing.array()).any()) {
    throw InputError(subject, "contradicts itself: its sform and its pixdim give different voxel sizes");
  }
  if (header.whole(254) > 0 && header.whole(252) > 0) {
    const Placement other = by_qform(subject, header, spacing);
    if ((other.steps - placement.steps).cwiseAbs().maxCoeff() > 0.01 * spacing.minCoeff()) {
      warnings.push_back("its sform and its qform turn it differently; the sform was taken");
    }
  }
}

GridGeometry geometry_of(const std::string& subject, const Bytes& header,
                         std::vector<std::string>& warnings) {
  const std::vector<double> sizes = sizes_of(subject, header);
  const std::vector<double> spacing{header.number(80), header.number(84), header.number(88)};
  const double unit_mm = unit_of(subject, header);
  const Placement placement = placement_of(subject, header, Vec3(spacing.data()), warnings);
  const Vec3& origin = placement.origin;
  checked_point(subject, "place", {origin.x(), origin.y(), origin.z()});
  const Vec3 lps_from_ras(-1, -1, 1);
  const GridGeometry geometry =
      checked_geometry(subject, sizes, spacing, placement.steps, origin, unit_mm, lps_from_ras);
  check_agreement(subject, header, placement, Vec3(spacing.data()), warnings);
  return geometry;
}

// A slope of 0 means that the values are as stored (nifti1.h).
void set_scaling(const std::string& subject, const Bytes& header, StoredVoxels& voxels,
                 std::vector<std::string>& warnings) {
  const double slope = header.number(112);
  const double intercept = header.number(116);
  if (!std::isfinite(intercept) || std::isinf(slope)) {
    throw InputError(subject, "has a scl_slope or scl_inter that is not a number");
  }
  if (std::isnan(slope)) {
    warnings.push_back("has a scl_slope that is not a number; its values were taken as stored");
  }
  if (std::isnan(slope) || slope == 0) return;
  voxels.slope = slope;
  voxels.intercept = intercept;
}

}  // namespace

VolumeHeader read_nifti_header(const fs::path& path) {
  const std::string subject = path.string();
  ByteSource source = open_source(subject, path);
  const Bytes header = read_header(subject, source);
  std::vector<std::string> warnings;
  const GridGeometry geometry = geometry_of(subject, header, warnings);
  const double offset = header.number(108);
  if (!(offset >= static_cast<double>(kHeaderBytes) && offset < 1e12)) {
    throw InputError(subject, fmt::format("says that its voxels begin at byte {}", offset));
  }
  StoredVoxels voxels{.source = std::move(source), .type = type_of(subject, header)};
  voxels.big_endian = header.is_big_endian();
  voxels.skip = static_cast<std::uint64_t>(offset) - kHeaderBytes;
  set_scaling(subject, header, voxels, warnings);
  constexpr int kIntentLabel = 1002;
  return {geometry, std::move(voxels), std::move(warnings), {}, header.whole(68) == kIntentLabel};
}

}  // namespace osteomill
