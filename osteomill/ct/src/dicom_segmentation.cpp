#include "dicom_segmentation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "plausible_scan.h"
#include "slice_stack.h"

namespace osteomill {

namespace {

// Tolerance for rounded positions, as a fraction of the spacing.
constexpr double kOffShare = 0.1;

// Grid of the frames, and the slice index of each frame.
struct FrameGrid {
  GridGeometry geometry;
  std::vector<int> slices;
};

// Returns the smallest distance between ascending heights that do not coincide; infinite if there is none.
double least_distance_mm(const std::vector<double>& heights_mm) {
  double least_mm = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < heights_mm.size(); ++n) {
    const double gap_mm = heights_mm[n] - heights_mm[n - 1];
    if (gap_mm > kSamePlace_mm) least_mm = std::min(least_mm, gap_mm);
  }
  return least_mm;
}

FrameGrid grid_of(const std::string& subject, const DicomHeader& header, const ReadOptions& options) {
  const SlicePlane& first = header.slices.front().plane;
  FrameGrid grid;
  GridGeometry& geometry = grid.geometry;
  geometry.direction.col(0) = first.i_direction.normalized();
  geometry.direction.col(2) = first.i_direction.cross(first.j_direction).normalized();
  geometry.direction.col(1) = geometry.direction.col(2).cross(geometry.direction.col(0));
  std::vector<Vec3> places_mm;
  std::vector<double> heights_mm;
  for (const DicomSlice& slice : header.slices) {
    if (const char* const difference = difference_of(first, slice.plane))
      throw InputError(subject, fmt::format("has frames that differ in {}", difference));
    places_mm.push_back(geometry.direction.transpose() * (slice.plane.position_mm - first.position_mm));
    heights_mm.push_back(places_mm.back().z());
  }
  std::sort(heights_mm.begin(), heights_mm.end());
  const double said_mm = std::abs(header.slice_distance_mm);
  const double least_mm = least_distance_mm(heights_mm);
  const double step_mm = said_mm > 0 ? said_mm : least_mm;
  if (!(step_mm > 0 && std::isfinite(step_mm)))
    throw InputError(subject, "has frames at one position and no slice thickness");
  const double steps = (heights_mm.back() - heights_mm.front()) / step_mm;
  if (!(steps < 1 << 16)) throw InputError(subject, "has frames too far apart for its slice distance");
  geometry.dims = {first.columns, first.rows, static_cast<int>(std::round(steps)) + 1};
  geometry.spacing_mm = {first.column_distance_mm, first.row_distance_mm, step_mm};
  geometry.origin_mm = first.position_mm + heights_mm.front() * geometry.direction.col(2);
  check_plausible(subject, geometry);
  check_memory(subject, 2 * geometry.voxel_count(), options.max_memory_bytes);
  for (const Vec3& place_mm : places_mm) {
    const double step = (place_mm.z() - heights_mm.front()) / step_mm;
    const bool is_off = std::abs(step - std::round(step)) > kOffShare ||
                        std::abs(place_mm.x()) > kOffShare * first.column_distance_mm ||
                        std::abs(place_mm.y()) > kOffShare * first.row_distance_mm;
    if (is_off) throw InputError(subject, "has frames that are not on a straight, even grid");
    grid.slices.push_back(static_cast<int>(std::round(step)));
  }
  return grid;
}

}  // namespace

Scan read_segmentation(const std::string& subject, const DicomHeader& header, const ReadOptions& options) {
  const FrameGrid grid = grid_of(subject, header, options);
  const GridGeometry& geometry = grid.geometry;
  std::vector<float> labels(geometry.voxel_count(), 0.0F);
  const std::size_t slice_size =
      static_cast<std::size_t>(geometry.dims[0]) * static_cast<std::size_t>(geometry.dims[1]);
  std::vector<float> frame(slice_size);
  std::size_t overlaps = 0;
  const auto keep = [&](std::size_t number) {
    const DicomSlice& slice = header.slices[number];
    float* label = &labels[static_cast<std::size_t>(grid.slices[number]) * slice_size];
    for (const float value : frame) {
      float found = value;
      if (slice.segment != 0)
        found = value >= header.least_segment_value ? static_cast<float>(slice.segment) : 0;
      overlaps += *label != 0 && found != 0 && *label != found;
      *label = std::max(*label, found);
      ++label;
    }
  };
  std::size_t last = header.slices.size();
  read_dicom_densities(header, [&](std::size_t number) {
    if (last < header.slices.size()) keep(last);
    WorkProgress::done(number, header.slices.size());
    last = number;
    return frame.data();
  });
  keep(last);
  std::vector<std::string> warnings;
  if (overlaps > 0) {
    warnings.push_back(fmt::format(
        "{} voxels are in several segments: they were assigned to the one with the highest number",
        overlaps));
  }
  Scan scan{DensityGrid(geometry, std::move(labels)), subject, "DICOM", std::move(warnings)};
  scan.is_labels = true;
  scan.labels = header.segments;
  return scan;
}

}  // namespace osteomill
