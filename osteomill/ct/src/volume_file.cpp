#include "volume_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include <Eigen/SVD>
#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "header_text.h"
#include "label_table.h"
#include "plausible_scan.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

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
  if (product > 1e12)
    throw InputError(subject, fmt::format("states an impossible size: {:.3g} voxels", product));
  return dims;
}

// Returns the nearest orthonormal axes with the same handedness.
Mat3 straightened(const Mat3& axes) {
  const Eigen::JacobiSVD<Mat3> parts(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return parts.matrixU() * parts.matrixV().transpose();
}

}  // namespace

std::vector<double> HeaderFields::numbers(const std::string& name) const {
  const auto found = parse_numbers((*this)[name]);
  if (!found || found->empty())
    throw InputError(subject, fmt::format("has a field \"{}\" without numbers", name));
  return *found;
}

double HeaderFields::count(const std::string& name, double min) const {
  if (!has(name)) return 0;
  const std::vector<double> found = numbers(name);
  if (found.size() != 1 || !(found[0] >= min && found[0] < 1e12))
    throw InputError(subject, fmt::format("has a {} that is not supported: {}", name, (*this)[name]));
  return found[0];
}

namespace {

constexpr std::size_t kMostFiles = 1 << 20;

// Replaces a conversion such as "%03d" or "%d" by a number; nullopt if the pattern has none or several.
std::optional<std::string> format_file_name(const std::string& pattern, long number) {
  const std::size_t percent = pattern.find('%');
  std::size_t at = percent + 1;
  if (percent == std::string::npos || pattern.find('%', at) != std::string::npos) return std::nullopt;
  const bool zeros = at < pattern.size() && pattern[at] == '0';
  std::size_t width = 0;
  for (; at < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[at])) != 0 && width < 100;
       ++at)
    width = 10 * width + static_cast<std::size_t>(pattern[at] - '0');
  if (at == pattern.size() || (pattern[at] != 'd' && pattern[at] != 'i' && pattern[at] != 'u'))
    return std::nullopt;
  const std::string digits = fmt::format("{}", std::abs(number)), sign = number < 0 ? "-" : "";
  const std::size_t have = digits.size() + sign.size();
  const std::string padding(width - std::min(width, have), zeros ? '0' : ' ');
  return pattern.substr(0, percent) + (zeros ? sign + padding : padding + sign) + digits +
         pattern.substr(at + 1);
}

// Returns the names that a pattern and its numbers stand for; nullopt if it is a plain name.
std::optional<std::vector<std::string>> names_of_pattern(const std::string& subject,
                                                         const std::string& said) {
  std::istringstream in(said);
  std::string pattern;
  long first = 0, last = 0, step = 0;
  if (!(in >> pattern >> first >> last >> step) || !format_file_name(pattern, first)) return std::nullopt;
  if (step == 0 || (last - first) / step < 0 ||
      static_cast<std::size_t>((last - first) / step) >= kMostFiles) {
    throw InputError(subject,
                     fmt::format("names its data files by an invalid range of numbers: {:.80}", said));
  }
  std::vector<std::string> names;
  for (long n = 0; n <= (last - first) / step; ++n)
    names.push_back(*format_file_name(pattern, first + n * step));
  return names;
}

std::vector<std::string> names_in_lines(const std::string& subject, std::istream& header) {
  constexpr std::size_t kMostLetters = 1 << 24;
  std::vector<std::string> names;
  std::size_t letters = 0;
  for (std::string line; std::getline(header, line);) {
    letters += line.size();
    if (letters > kMostLetters || names.size() == kMostFiles || line.find('\0') != std::string::npos)
      throw InputError(subject, "has an invalid list of data files");
    if (line = trimmed(line); !line.empty()) names.push_back(line);
  }
  if (names.empty()) throw InputError(subject, "has an empty list of data files");
  return names;
}

}  // namespace

std::vector<fs::path> data_files(const std::string& subject, const fs::path& path, const std::string& said,
                                 std::istream& header) {
  std::vector<std::string> names{said};
  if (said == "LIST" || said.starts_with("LIST ")) {
    names = names_in_lines(subject, header);
  } else if (auto of_pattern = names_of_pattern(subject, said)) {
    names = *std::move(of_pattern);
  }
  std::vector<fs::path> files;
  for (const std::string& name : names) files.push_back(path.parent_path() / name);
  return files;
}

double max_skew(const Mat3& axes) {
  const Mat3 ones = axes.colwise().normalized();
  return std::max({std::abs(ones.col(0).dot(ones.col(1))), std::abs(ones.col(1).dot(ones.col(2))),
                   std::abs(ones.col(2).dot(ones.col(0)))});
}

GridGeometry checked_geometry(const std::string& subject, const std::vector<double>& sizes,
                              const std::vector<double>& spacing, const Mat3& axes, const Vec3& origin,
                              double unit_mm, std::vector<std::string>& warnings, const Vec3& lps_from_axes) {
  // Axes are turned by half of this at most, which moves the end of a 400 mm scan by less than 1 mm.
  constexpr double kMostShear = 4.4e-3;
  GridGeometry geometry;
  geometry.dims = checked_dims(subject, sizes);
  if (spacing.size() != 3) throw InputError(subject, fmt::format("has {} spacings, not 3", spacing.size()));
  if (!axes.allFinite()) throw InputError(subject, "has an axis that is not finite");
  if (!((axes.colwise().norm().array() > 0).all())) throw InputError(subject, "has an axis of zero length");
  const double skew = max_skew(axes);
  if (!(skew <= kMostShear)) {
    throw InputError(
        subject, "has axes that are not at right angles (a sheared or flat grid), which is not supported");
  }
  geometry.spacing_mm = Vec3(spacing.data()) * unit_mm;
  Mat3 directions = axes.colwise().normalized();
  Vec3 first_mm = origin * unit_mm;
  if (skew > kNoShear) {
    // Keeps the centre of the scan in place.
    const Mat3 straight = straightened(directions);
    const Vec3 middle(0.5 * (sizes[0] - 1), 0.5 * (sizes[1] - 1), 0.5 * (sizes[2] - 1));
    first_mm += (directions - straight) * geometry.spacing_mm.cwiseProduct(middle);
    directions = straight;
    warnings.push_back(
        fmt::format("has axes that are {:.2g} degrees off right angles; they were straightened",
                    std::asin(skew) * 57.29577951308232));
  }
  // Adding 0 turns -0 into 0.
  geometry.origin_mm = lps_from_axes.cwiseProduct(first_mm).array() + 0.0;
  geometry.direction = (lps_from_axes.asDiagonal() * directions).array() + 0.0;
  check_plausible(subject, geometry);
  return geometry;
}

Vec3 checked_point(const std::string& subject, const std::string& name, const std::vector<double>& numbers) {
  const bool is_point = numbers.size() == 3 && std::all_of(numbers.begin(), numbers.end(), [](double number) {
                          return std::isfinite(number);
                        });
  if (!is_point) throw InputError(subject, fmt::format("has a {} that is not three numbers", name));
  return Vec3(numbers.data());
}

double millimetres_in(const std::string& subject, std::string_view unit) {
  static const std::map<std::string, double, std::less<>> kUnits{
      {"", 1},           {"mm", 1},         {"millimeter", 1}, {"millimetre", 1},
      {"um", 1e-3},      {"µm", 1e-3},      {"micron", 1e-3},  {"micrometer", 1e-3},
      {"microns", 1e-3}, {"nm", 1e-6},      {"cm", 10},        {"m", 1000},
      {"?", 1},          {"millimeters", 1}};
  const auto found = kUnits.find(unit);
  if (found == kUnits.end())
    throw InputError(subject, fmt::format("has lengths in the unknown unit \"{:.40}\"", unit));
  return found->second;
}

const VolumeFormat* volume_format_of(const fs::path& path) {
  static const VolumeFormat kNrrd{"NRRD", {".nrrd", ".nhdr"}, read_nrrd_header};
  static const VolumeFormat kMetaImage{"MetaImage", {".mha", ".mhd"}, read_metaimage_header};
  static const VolumeFormat kNifti{"NIfTI", {".nii", ".nii.gz", ".hdr", ".hdr.gz"}, read_nifti_header};
  const std::string name = lower(path.filename().string());
  for (const VolumeFormat* format : {&kNrrd, &kMetaImage, &kNifti}) {
    for (const std::string_view ending : format->endings) {
      if (name.ends_with(ending)) return format;
    }
  }
  return header_of_voxels(path) ? &kNifti : nullptr;
}

std::vector<float> read_volume(const std::string& subject, VolumeHeader& header, std::uint64_t max_bytes) {
  const std::uint64_t layers = header.layers.count;
  std::vector<float> values =
      read_voxels(subject, header.voxels, header.geometry.voxel_count() * layers, max_bytes, header.warnings);
  return layers == 1 ? values : merge_layers(subject, std::move(values), header);
}

Scan read_volume_file(const fs::path& path, const VolumeFormat& format, const ReadOptions& options) {
  const std::string subject = path.string();
  VolumeHeader header = format.read_header(path);
  if (!options.series.empty()) {
    throw InputError(subject, fmt::format("is {}, which has no series to choose from", format.name));
  }
  std::vector<float> densities;
  {
    const WorkProgress::Part reading(0.85);
    densities = read_volume(subject, header, options.max_memory_bytes);
  }
  const WorkProgress::Part checking(1);
  if (const std::size_t none = check_densities(subject, densities); none > 0) {
    header.warnings.push_back(
        fmt::format("{} voxels have no density (NaN): they were set to the lowest of the others", none));
  }
  Scan scan{DensityGrid(header.geometry, std::move(densities)), subject, format.name,
            std::move(header.warnings)};
  scan.is_labels = header.is_labels || subject.find(".seg.") != std::string::npos ||
                   std::any_of(header.texts.begin(), header.texts.end(),
                               [](const std::string& text) { return !labels_in_text(text).empty(); });
  return scan;
}

}  // namespace osteomill
