#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Position of one slice of a series according to its header; sizes are above 0, numbers finite. In mm, in
/// the patient's LPS frame W.
struct SlicePlane {
  /// Name of the slice in messages.
  std::string name;
  /// Identifier (SOPInstanceUID and frame); slices with the same one are copies.
  std::string instance;
  int columns = 0;
  int rows = 0;
  /// Distance between neighbouring columns (along i) and rows (along j).
  double column_distance_mm = 0;
  double row_distance_mm = 0;
  /// Directions of increasing i and j.
  Vec3 i_direction = Vec3::UnitX();
  Vec3 j_direction = Vec3::UnitY();
  /// Centre of the first pixel.
  Vec3 position_mm = Vec3::Zero();
  /// Number of decimals of each coordinate of the position in the file.
  std::array<int, 3> decimals{};
  /// Number of the slice in its series.
  std::optional<int> number{};
};

/// Slices closer than this along the normal count as coincident.
inline constexpr double kSamePlace_mm = 1e-4;

/// Returns whether two slices, given by index, have the same pixels.
using SamePixels = std::function<bool(std::size_t, std::size_t)>;

/// Returns why two slices cannot belong to one volume: "size", "pixel spacing" or "orientation"; null if they
/// can.
const char* difference_of(const SlicePlane& one, const SlicePlane& other);

/// Slices ordered along their common normal.
struct SliceStack {
  /// Straight grid of the slices, except for `heights_mm` and the drift.
  GridGeometry geometry;
  /// Slice index for each k, without copies.
  std::vector<std::size_t> order;
  /// Height of each slice above the lowest if the slices are not even. The grid may then have more or fewer
  /// slices, to be interpolated by `resample_to_even_slices`. Empty if the slices are even.
  std::vector<double> heights_mm;
  /// Offset of each slice of the grid along i and j from the one below (gantry tilt), to be corrected by
  /// `correct_gantry_tilt`. Zero if the stack is straight.
  double drift_i_mm = 0;
  double drift_j_mm = 0;
  std::vector<std::string> warnings;
};

/// Sorts slices by their position along the normal, lowest first. Uneven distances, as after a change of the
/// table feed: the grid's spacing is about the 10th percentile of the distances, at least a quarter of the
/// mean, and a warning gives the largest. Rounded positions: if all lie within half of their last decimal of
/// an even grid in the order of consecutive slice numbers, uses that grid and adds a warning. Copies (same
/// `instance`, or `same_pixels` at the same position) are dropped. Throws InputError, naming `subject`, if
/// there is no common grid: fewer than two slices; different sizes, spacings or orientations; two different
/// images at one position; or, if uneven, a gap over 1.5 times its neighbours (a slice is missing) or over 10
/// mm.
SliceStack stack_slices(const std::string& subject, std::span<const SlicePlane> slices,
                        const SamePixels& same_pixels = {});

/// Resamples uneven slices (`SliceStack::heights_mm`) linearly to the stack's even grid, pixel by pixel, and
/// so along the table's axis if the gantry is tilted. Replaces `densities`, which hold the slices one after
/// the other as read. Does nothing if the stack is even.
void resample_to_even_slices(SliceStack& stack, std::vector<float>& densities);

/// Corrects gantry tilt: shifts every slice to its position in a straight grid by linear interpolation within
/// the slice. Enlarges the grid so that no pixel is lost, fills the rest with the lowest density, and adds a
/// warning. Replaces `densities` and updates `stack`. Does nothing if the stack is straight. Throws
/// InputError, naming `subject`, if the tilt exceeds what gantries can do.
void correct_gantry_tilt(const std::string& subject, SliceStack& stack, std::vector<float>& densities);

}  // namespace osteomill
