#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// The place of one slice of a series, as its header says: sizes above 0, numbers finite. All in mm, in the
/// patient's LPS frame W.
struct SlicePlane {
  /// The slice's name in a message.
  std::string name;
  /// Two slices with the same one are copies of each other (SOPInstanceUID and frame).
  std::string instance;
  int columns = 0;
  int rows = 0;
  /// Distance of neighbouring columns (along i) and of neighbouring rows (along j).
  double column_distance_mm = 0;
  double row_distance_mm = 0;
  /// Direction in which i, and j, grow.
  Vec3 i_direction = Vec3::UnitX();
  Vec3 j_direction = Vec3::UnitY();
  /// Centre of the first pixel.
  Vec3 position_mm = Vec3::Zero();
  /// How many decimals of each coordinate of the position the writer gave.
  std::array<int, 3> decimals{};
  /// The slice's number in its series.
  std::optional<int> number{};
};

/// Slices nearer to each other than this along the normal lie at one place.
inline constexpr double kSamePlace_mm = 1e-4;

/// Returns whether two slices, by their numbers, have the same pixels.
using SamePixels = std::function<bool(std::size_t, std::size_t)>;

/// Returns in what two slices differ so that they cannot be of one volume: "size", "pixel spacing" or
/// "orientation"; null if in nothing.
const char* difference_of(const SlicePlane& one, const SlicePlane& other);

/// Slices put in order along their common normal.
struct SliceStack {
  /// The straight grid on which the slices lie, or nearly: see `heights_mm` and the drift.
  GridGeometry geometry;
  /// For every k the number of the slice that lies there; copies are left out.
  std::vector<std::size_t> order;
  /// The height of each slice above the lowest, if these are not the heights of the grid's slices, which may
  /// then be more or fewer: their densities have to be interpolated (`even_out_slices`). Else empty.
  std::vector<double> heights_mm;
  /// By how much each of the grid's slices lies further along i and j than the one below: a gantry tilt. Zero
  /// if the stack is straight; else they have to be shifted before they are in their place.
  double drift_i_mm = 0;
  double drift_j_mm = 0;
  std::vector<std::string> warnings;
};

/// Puts the slices in order of their position along the normal, lowest first, whatever order they come in.
/// If their distances differ, as after a change of a table's feed, the grid is as fine as nine tenths of
/// them ask for, and a warning names the largest. If every position lies within half of its last decimal of
/// an even grid in the order of consecutive numbers of the slices, the writer has rounded it: that grid is
/// taken, with a warning. Of slices at one position those that are copies, by their instance or by
/// `same_pixels`, are left out. Throws InputError naming `subject` if no grid holds them all: fewer than
/// two, not all of one size, spacing and orientation, two at one position, or a gap that is over 1.5 times
/// those beside it (a slice is missing) or over 10 mm while others are less.
SliceStack stack_slices(const std::string& subject, std::span<const SlicePlane> slices,
                        const SamePixels& same_pixels = {});

/// Interpolates slices that lie at uneven distances (`SliceStack::heights_mm`) linearly to the even ones of
/// the stack's grid, from pixel to pixel, so along the axis of a tilted gantry's table. `densities`, slice
/// after slice as they were read, are replaced. An even stack is left alone.
void even_out_slices(SliceStack& stack, std::vector<float>& densities);

/// Moves every slice of a stack that was taken with a tilted gantry to its place in a straight grid, by
/// linear interpolation within the slice. The grid grows so that nothing is lost; `densities` and `stack` are
/// replaced, places without pixels get the least density, and a warning says so. A straight stack is left
/// alone. Throws InputError naming `subject` if the tilt is more than a gantry can do.
void correct_gantry_tilt(const std::string& subject, SliceStack& stack, std::vector<float>& densities);

}  // namespace osteomill
