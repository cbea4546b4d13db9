#include "osteomill/ct/volume_header.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "osteomill/ct/plausible_scan.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

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

}  // namespace

GridGeometry checked_geometry(const std::string& subject, const std::vector<double>& sizes,
                              const std::vector<double>& spacing, const Mat3& axes, const Vec3& origin,
                              double unit_mm, const Vec3& lps_from_axes) {
  GridGeometry geometry;
  geometry.dims = checked_dims(subject, sizes);
  check_spacing(subject, spacing);
  check_axes(subject, axes);
  geometry.spacing_mm = Vec3(spacing.data()) * unit_mm;
  // Adding 0 makes -0, which only puzzles, 0.
  geometry.origin_mm = (lps_from_axes.cwiseProduct(origin) * unit_mm).array() + 0.0;
  geometry.direction = (lps_from_axes.asDiagonal() * axes.colwise().normalized()).array() + 0.0;
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
    throw InputError(subject, fmt::format("has lengths in \"{}\", which is not known", unit));
  return found->second;
}

std::string trimmed(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t\r");
  if (start == std::string_view::npos) return {};
  return std::string(text.substr(start, text.find_last_not_of(" \t\r") - start + 1));
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace osteomill
