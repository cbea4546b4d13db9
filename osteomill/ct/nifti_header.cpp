// NIfTI-1, https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <zlib.h>

#include "osteomill/ct/volume_header.h"
#include "osteomill/files/input_error.h"

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

bool is_gzip(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return in.get() == 0x1F && in.get() == 0x8B;
}

// zlib reads a file that is not compressed as it is.
Bytes read_header(const std::string& subject) {
  std::array<char, kHeaderBytes> bytes{};
  gzFile file = gzopen(subject.c_str(), "rb");
  if (file == nullptr) throw InputError(subject, "cannot be read");
  const int count = gzread(file, bytes.data(), kHeaderBytes);
  gzclose(file);
  if (count != static_cast<int>(kHeaderBytes)) throw InputError(subject, "is cut short in its header");
  Bytes header(bytes);
  if (header.at<std::int32_t>(0) != static_cast<std::int32_t>(kHeaderBytes)) header.swap_order();
  if (header.at<std::int32_t>(0) != static_cast<std::int32_t>(kHeaderBytes)) {
    throw InputError(subject, "is not NIfTI-1: its header does not have 348 bytes");
  }
  if (header.text(344, 3) != "n+1")
    throw InputError(subject, "is not NIfTI-1 in one file: its magic is not n+1");
  return header;
}

std::array<int, 3> dims_of(const std::string& subject, const Bytes& header) {
  const int dimensions = header.whole(40);
  if (dimensions < 3 || dimensions > 7) {
    throw InputError(subject, fmt::format("is not a volume: it has {} dimensions", dimensions));
  }
  for (int axis = 4; axis <= dimensions; ++axis) {
    const int size = header.whole(40 + 2 * static_cast<std::size_t>(axis));
    if (size > 1) throw InputError(subject, fmt::format("holds {} volumes or values a voxel, not one", size));
  }
  return checked_dims(subject, {static_cast<double>(header.whole(42)), static_cast<double>(header.whole(44)),
                                static_cast<double>(header.whole(46))});
}

std::uint64_t value_bytes(const std::string& subject, const Bytes& header) {
  const int type = header.whole(70);
  switch (type) {
    case 2:
    case 256:
      return 1;
    case 4:
    case 512:
      return 2;
    case 8:
    case 16:
    case 768:
      return 4;
    case 64:
    case 1024:
    case 1280:
      return 8;
    default:
      throw InputError(subject,
                       fmt::format("has voxels of type {}, which is not grey or not supported", type));
  }
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

Placement by_sform(const std::string& subject, const Bytes& header) {
  Placement placement;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double value =
          header.number(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(column));
      (column < 3 ? placement.steps(row, column) : placement.origin[row]) = value;
    }
  }
  check_axes(subject, placement.steps);
  return placement;
}

Placement by_qform(const Bytes& header, const Vec3& spacing) {
  const Vec3 bcd(header.number(256), header.number(260), header.number(264));
  const Quat rotation(std::sqrt(std::max(0.0, 1 - bcd.squaredNorm())), bcd.x(), bcd.y(), bcd.z());
  const double qfac = header.number(76) < 0 ? -1 : 1;
  return {rotation.normalized().toRotationMatrix() *
              Vec3(spacing.x(), spacing.y(), qfac * spacing.z()).asDiagonal(),
          Vec3(header.number(268), header.number(272), header.number(276))};
}

Placement placement_of(const std::string& subject, const Bytes& header, const Vec3& spacing,
                       std::vector<std::string>& warnings) {
  const bool has_qform = header.whole(252) > 0;
  if (header.whole(254) > 0) {
    const Placement placement = by_sform(subject, header);
    const Vec3 lengths = placement.steps.colwise().norm();
    if (((lengths - spacing).cwiseAbs().array() > kAgreement * spacing.array()).any()) {
      throw InputError(subject, "contradicts itself: its sform and its pixdim give different voxel sizes");
    }
    if (has_qform) {
      const Placement other = by_qform(header, spacing);
      if ((other.steps - placement.steps).cwiseAbs().maxCoeff() > 0.01 * spacing.minCoeff()) {
        warnings.push_back("its sform and its qform turn it differently; the sform was taken");
      }
    }
    return placement;
  }
  if (has_qform) return by_qform(header, spacing);
  warnings.push_back("does not say how it lies in the patient; its axes were taken for RAS");
  return {spacing.asDiagonal(), Vec3::Zero()};
}

GridGeometry geometry_of(const std::string& subject, const Bytes& header, VolumeHeader& result) {
  const Vec3 spacing(header.number(80), header.number(84), header.number(88));
  check_spacing(subject, {spacing.x(), spacing.y(), spacing.z()});
  const Placement placement = placement_of(subject, header, spacing, result.warnings);
  if (!placement.steps.allFinite() || !placement.origin.allFinite()) {
    throw InputError(subject, "has a place that is not made of numbers");
  }
  const Vec3 lps_from_ras(-1, -1, 1);
  GridGeometry geometry;
  geometry.dims = result.dims;
  geometry.spacing_mm = spacing * result.unit_mm;
  // Adding 0 makes -0, which only puzzles, 0.
  geometry.origin_mm = (lps_from_ras.cwiseProduct(placement.origin) * result.unit_mm).array() + 0.0;
  geometry.direction = (lps_from_ras.asDiagonal() * placement.steps.colwise().normalized()).array() + 0.0;
  return geometry;
}

// A slope of 0 means that the values are as stored (nifti1.h), yet ITK adds the intercept.
void check_scaling(const std::string& subject, const Bytes& header, VolumeHeader& result) {
  const double slope = header.number(112);
  const double intercept = header.number(116);
  if (!std::isfinite(intercept) || std::isinf(slope)) {
    throw InputError(subject, "has a scl_slope or scl_inter that is not a number");
  }
  if (std::isnan(slope)) {
    result.warnings.push_back("has a scl_slope that is not a number; its values were taken as stored");
  }
  if (std::isnan(slope) || slope == 0) result.added_by_itk = intercept;
}

}  // namespace

VolumeHeader check_nifti(const fs::path& path) {
  const std::string subject = path.string();
  const Bytes header = read_header(subject);
  VolumeHeader result;
  result.dims = dims_of(subject, header);
  result.unit_mm = unit_of(subject, header);
  result.geometry = geometry_of(subject, header, result);
  check_scaling(subject, header, result);

  const double offset = header.number(108);
  if (!(offset >= static_cast<double>(kHeaderBytes) && offset < 1e12)) {
    throw InputError(subject, fmt::format("says that its voxels begin at byte {}", offset));
  }
  StoredVoxels stored;
  stored.file = path;
  stored.bytes = result.geometry->voxel_count() * value_bytes(subject, header);
  stored.compressed = is_gzip(path);
  (stored.compressed ? stored.compressed_skip : stored.offset) = static_cast<std::uint64_t>(offset);
  const std::vector<std::string> more = check_stored(subject, stored);
  result.warnings.insert(result.warnings.end(), more.begin(), more.end());
  return result;
}

}  // namespace osteomill
