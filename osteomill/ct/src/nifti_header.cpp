// NIfTI-1 and NIfTI-2, https://nifti.nimh.nih.gov/nifti-1 and /nifti-2, in one file or in two.
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "header_text.h"
#include "volume_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeader1Bytes = 348;
constexpr std::size_t kHeader2Bytes = 540;
constexpr double kAgreement = 1e-3;

// Opens a file that may be compressed.
ByteSource open_source(const std::string& subject, const fs::path& path) {
  std::ifstream in = open_regular_file(subject, path);
  const bool packed = in.get() == 0x1F && in.get() == 0x8B;
  in.clear();
  in.seekg(0);
  return {std::move(in), packed ? Packing::gzip_or_zlib : Packing::none};
}

// Bytes of the header, read as numbers by offset.
class Bytes {
 public:
  Bytes(const std::string& subject, ByteSource& source) {
    read(subject, source, 0, kHeader1Bytes);
    if (is_length(kHeader2Bytes)) read(subject, source, kHeader1Bytes, kHeader2Bytes);
    if (!is_length(kHeader1Bytes) && !is_length(kHeader2Bytes)) {
      throw InputError(subject, "is not NIfTI: its header has neither 348 nor 540 bytes");
    }
  }

  bool is_big_endian() const { return swap_ != (std::endian::native == std::endian::big); }
  bool is_nifti2() const { return length_ == kHeader2Bytes; }
  std::size_t length() const { return length_; }

  template <typename Number>
  Number at(std::size_t offset) const {
    std::array<char, sizeof(Number)> raw{};
    for (std::size_t n = 0; n < sizeof(Number); ++n) {
      raw[swap_ ? sizeof(Number) - 1 - n : n] = bytes_[offset + n];
    }
    return std::bit_cast<Number>(raw);
  }
  std::string_view text(std::size_t offset, std::size_t length) const {
    return {bytes_.data() + offset, length};
  }

 private:
  void read(const std::string& subject, ByteSource& source, std::size_t from, std::size_t to) {
    if (source.read(std::span(bytes_).subspan(from, to - from)) != to - from)
      throw InputError(subject, "is cut short in its header");
  }
  // Tries both byte orders.
  bool is_length(std::size_t bytes) {
    length_ = bytes;
    for (int n = 0; n < 2; ++n) {
      if (at<std::int32_t>(0) == static_cast<std::int32_t>(bytes)) return true;
      swap_ = !swap_;
    }
    return false;
  }

  std::array<char, kHeader2Bytes> bytes_{};
  std::size_t length_ = 0;
  bool swap_ = false;
};

// Fields read from a header of either version.
struct Header {
  std::string subject;
  // dim[0] to dim[7].
  std::array<double, 8> sizes{};
  double qfac = 1;
  Vec3 spacing;
  int type = 0;
  double offset = 0;
  double slope = 0;
  double intercept = 0;
  int qform_code = 0;
  int sform_code = 0;
  Vec3 quaternion_bcd;
  Vec3 qoffset;
  std::array<double, 12> rows{};
  int units = 0;
  int intent = 0;
  bool is_pair = false;
};

// Returns the nth number of an array at `offset`, whose type is Small in NIfTI-1 and Large in NIfTI-2.
template <typename Small, typename Large>
double number(const Bytes& bytes, std::size_t offset, std::size_t n) {
  return bytes.is_nifti2() ? static_cast<double>(bytes.at<Large>(offset + n * sizeof(Large)))
                           : static_cast<double>(bytes.at<Small>(offset + n * sizeof(Small)));
}

Header header_of(const std::string& subject, const Bytes& bytes) {
  const bool two = bytes.is_nifti2();
  const auto place = [&](std::size_t first, std::size_t second) { return two ? second : first; };
  const auto real = [&](std::size_t first, std::size_t second, std::size_t n = 0) {
    return number<float, double>(bytes, place(first, second), n);
  };
  const auto code = [&](std::size_t first, std::size_t second) {
    return static_cast<int>(number<std::int16_t, std::int32_t>(bytes, place(first, second), 0));
  };
  const auto vector = [&](std::size_t first, std::size_t second, std::size_t n = 0) {
    return Vec3(real(first, second, n), real(first, second, n + 1), real(first, second, n + 2));
  };
  const std::string_view magic = bytes.text(place(344, 4), 3), digit = two ? "2" : "1";
  if (!two && magic.front() == '\0')
    throw InputError(subject, "is Analyze 7.5, not NIfTI: left and right are undefined; convert it to NIfTI");
  if ((magic.substr(0, 2) != "n+" && magic.substr(0, 2) != "ni") || magic.substr(2) != digit)
    throw InputError(subject, fmt::format("is not NIfTI: its magic is neither n+{0} nor ni{0}", digit));
  Header header{subject};
  header.is_pair = magic[1] == 'i';
  for (std::size_t n = 0; n < header.sizes.size(); ++n)
    header.sizes[n] = number<std::int16_t, std::int64_t>(bytes, place(40, 16), n);
  header.qfac = real(76, 104) < 0 ? -1 : 1;
  // Some writers give spacings a sign, but the directions of the axes are stored elsewhere.
  header.spacing = vector(76, 104, 1).cwiseAbs();
  header.type = bytes.at<std::int16_t>(place(70, 12));
  header.offset = two ? static_cast<double>(bytes.at<std::int64_t>(168)) : real(108, 0);
  header.slope = real(112, 176);
  header.intercept = real(116, 184);
  header.qform_code = code(252, 344);
  header.sform_code = code(254, 348);
  header.quaternion_bcd = vector(256, 352);
  header.qoffset = vector(268, 376);
  for (std::size_t n = 0; n < header.rows.size(); ++n) header.rows[n] = real(280, 400, n);
  header.units = two ? bytes.at<std::int32_t>(500) : bytes.at<std::int8_t>(123);
  header.intent = code(68, 504);
  return header;
}

std::vector<double> sizes_of(const Header& header) {
  const double dimensions = header.sizes[0];
  if (!(dimensions >= 3 && dimensions <= 7)) {
    throw InputError(header.subject, fmt::format("is not a volume: it has {} dimensions", dimensions));
  }
  for (std::size_t axis = 4; axis <= static_cast<std::size_t>(dimensions); ++axis) {
    if (header.sizes[axis] > 1) {
      throw InputError(header.subject,
                       fmt::format("holds {} volumes or values per voxel, not one", header.sizes[axis]));
    }
  }
  return {header.sizes[1], header.sizes[2], header.sizes[3]};
}

VoxelType type_of(const Header& header) {
  using enum VoxelType;
  static const std::map<int, VoxelType> kTypes{{2, uint8},    {4, int16},    {8, int32},    {16, float32},
                                               {64, float64}, {256, int8},   {512, uint16}, {768, uint32},
                                               {1024, int64}, {1280, uint64}};
  const auto found = kTypes.find(header.type);
  if (found == kTypes.end()) {
    throw InputError(header.subject,
                     fmt::format("has voxels of type {}, which is not supported", header.type));
  }
  return found->second;
}

double unit_of(const Header& header) {
  switch (header.units & 7) {
    case 0:
    case 2:
      return 1;
    case 1:
      return 1000;
    case 3:
      return 1e-3;
    default:
      throw InputError(header.subject, "has lengths in an unknown unit");
  }
}

// Steps from voxel to voxel (columns) and position of the first voxel, in RAS.
struct Placement {
  Mat3 steps;
  Vec3 origin;
};

Placement by_sform(const Header& header) {
  Placement placement;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const auto r = static_cast<Eigen::Index>(row), c = static_cast<Eigen::Index>(column);
      (column < 3 ? placement.steps(r, c) : placement.origin[r]) = header.rows[4 * row + column];
    }
  }
  return placement;
}

// Returns nullopt if the quaternion is not a rotation.
std::optional<Placement> by_qform(const Header& header) {
  const Vec3& bcd = header.quaternion_bcd;
  if (!(bcd.norm() < 1.01) || !header.qoffset.allFinite()) return std::nullopt;
  const Quat rotation(std::sqrt(std::max(0.0, 1 - bcd.squaredNorm())), bcd.x(), bcd.y(), bcd.z());
  const Vec3 spacing(header.spacing.x(), header.spacing.y(), header.qfac * header.spacing.z());
  return Placement{rotation.normalized().toRotationMatrix() * spacing.asDiagonal(), header.qoffset};
}

bool has_sizes_of(const Placement& placement, const Vec3& spacing) {
  const Vec3 lengths = placement.steps.colwise().norm();
  return ((lengths - spacing).cwiseAbs().array() <= kAgreement * spacing.array()).all();
}

// Returns why a placement cannot be used as it is; empty if it can.
std::string fault_of(const Placement& placement, const Vec3& spacing) {
  if (!placement.steps.allFinite() || !placement.origin.allFinite())
    return "holds values that are not finite";
  if (!((placement.steps.colwise().norm().array() > 0).all())) return "has an axis of zero length";
  if (!has_sizes_of(placement, spacing)) return "contradicts the voxel sizes in pixdim";
  if (max_skew(placement.steps) > kNoShear) return "is sheared";
  return "";
}

// Prefers the sform, as nibabel and 3D Slicer do; if it is unusable, the qform, as ITK does.
Placement placement_of(const Header& header, std::vector<std::string>& warnings) {
  const std::optional<Placement> qform =
      header.qform_code > 0 && (header.spacing.array() > 0).all() ? by_qform(header) : std::nullopt;
  if (header.sform_code > 0) {
    const Placement sform = by_sform(header);
    const std::string fault = fault_of(sform, header.spacing);
    if (!qform) return sform;
    if (!fault.empty()) {
      warnings.push_back(fmt::format("its sform {}; its qform was used", fault));
      return *qform;
    }
    if ((qform->steps - sform.steps).cwiseAbs().maxCoeff() > 0.01 * header.spacing.minCoeff())
      warnings.push_back("its sform and qform differ in rotation; the sform was used");
    else if ((qform->origin - sform.origin).cwiseAbs().maxCoeff() > 0.5 * header.spacing.minCoeff())
      warnings.push_back("its sform and qform differ in position; the sform was used");
    return sform;
  }
  if (header.qform_code > 0) {
    if (const auto placement = by_qform(header)) return *placement;
    throw InputError(header.subject, "has a qform that is not a rotation");
  }
  warnings.push_back("does not state its orientation in the patient; its axes were assumed to be RAS");
  return {header.spacing.asDiagonal(), Vec3::Zero()};
}

GridGeometry geometry_of(const Header& header, std::vector<std::string>& warnings) {
  const std::vector<double> sizes = sizes_of(header);
  const std::vector<double> spacing(header.spacing.begin(), header.spacing.end());
  const double unit_mm = unit_of(header);
  const Placement placement = placement_of(header, warnings);
  const Vec3& origin = placement.origin;
  checked_point(header.subject, "place", {origin.x(), origin.y(), origin.z()});
  const Vec3 lps_from_ras(-1, -1, 1);
  const GridGeometry geometry = checked_geometry(header.subject, sizes, spacing, placement.steps, origin,
                                                 unit_mm, warnings, lps_from_ras);
  if (!has_sizes_of(placement, header.spacing)) {
    throw InputError(header.subject,
                     "contradicts itself: its sform and its pixdim give different voxel sizes");
  }
  return geometry;
}

// A slope of 0 or NaN means unscaled values (nifti1.h; nibabel writes NaN for slope and intercept).
void set_scaling(const Header& header, StoredVoxels& voxels, std::vector<std::string>& warnings) {
  if (std::isnan(header.slope)) {
    warnings.push_back("has a scl_slope that is not a number; its values were not rescaled");
  }
  if (std::isnan(header.slope) || header.slope == 0) return;
  if (!std::isfinite(header.intercept) || std::isinf(header.slope)) {
    throw InputError(header.subject, "has a scl_slope or scl_inter that is not finite");
  }
  voxels.slope = header.slope;
  voxels.intercept = header.intercept;
}

// Returns the texts of the extensions, which start at the source's position after the header and have at most
// `most` bytes. Adds the bytes read to `used`.
std::vector<std::string> extensions(const Bytes& bytes, ByteSource& source, std::uint64_t most,
                                    std::uint64_t& used) {
  constexpr std::size_t kMostBytes = 1 << 24, kHead = 8;
  std::array<char, 4> extender{};
  if (most < extender.size() || source.read(extender) != extender.size()) return {};
  used += extender.size();
  if (extender[0] == 0) return {};
  std::string rest(std::min<std::uint64_t>(most - extender.size(), kMostBytes), '\0');
  rest.resize(source.read(rest));
  used += rest.size();
  std::vector<std::string> texts;
  for (std::size_t at = 0; at + kHead <= rest.size();) {
    std::array<char, 4> raw{};
    for (std::size_t n = 0; n < raw.size(); ++n) raw[bytes.is_big_endian() ? 3 - n : n] = rest[at + n];
    const auto size = std::bit_cast<std::uint32_t>(raw);
    if (size < kHead || size > rest.size() - at) break;
    texts.push_back(rest.substr(at + kHead, size - kHead));
    at += size;
  }
  return texts;
}

std::string without_ending(const fs::path& path) {
  std::string name = path.string();
  if (lower(name).ends_with(".gz")) name.resize(name.size() - 3);
  return name.substr(0, name.size() - 4);
}

// Returns the existing file in the same folder with the same name and one of these endings; nullopt if there
// is none.
std::optional<fs::path> beside(const fs::path& path, const char* small, const char* large) {
  std::error_code error;
  for (const std::string ending : {small, large}) {
    for (const char* packed : {"", ".gz"}) {
      const fs::path other = without_ending(path) + ending + packed;
      if (fs::exists(other, error)) return other;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<fs::path> header_of_voxels(const fs::path& path) {
  const std::string name = lower(path.filename().string());
  return name.ends_with(".img") || name.ends_with(".img.gz") ? beside(path, ".hdr", ".HDR") : std::nullopt;
}

VolumeHeader read_nifti_header(const fs::path& path) {
  const std::string subject = path.string();
  const fs::path header_path = header_of_voxels(path).value_or(path);
  ByteSource source = open_source(subject, header_path);
  const Bytes bytes(subject, source);
  const Header header = header_of(subject, bytes);
  std::vector<std::string> warnings;
  const GridGeometry geometry = geometry_of(header, warnings);
  const auto least = static_cast<double>(header.is_pair ? 0 : bytes.length());
  if (!(header.offset >= least && header.offset < 1e12)) {
    throw InputError(subject, fmt::format("has an invalid offset of its voxels: {} bytes", header.offset));
  }
  const auto offset = static_cast<std::uint64_t>(header.offset);
  std::uint64_t used = bytes.length();
  std::vector<std::string> texts =
      extensions(bytes, source, header.is_pair ? source.max_bytes() : offset - used, used);
  if (header.is_pair) {
    const auto voxels = beside(header_path, ".img", ".IMG");
    if (!voxels)
      throw InputError(subject,
                       "its voxels are missing; copy the .img file of the same name into its folder");
    source = open_source(subject, *voxels);
    used = 0;
  }
  StoredVoxels voxels{.source = std::move(source), .type = type_of(header)};
  voxels.big_endian = bytes.is_big_endian();
  voxels.skip = offset - used;
  set_scaling(header, voxels, warnings);
  constexpr int kIntentLabel = 1002;
  VolumeHeader read{geometry, std::move(voxels), std::move(warnings)};
  read.is_labels = header.intent == kIntentLabel;
  read.texts = std::move(texts);
  return read;
}

}  // namespace osteomill
