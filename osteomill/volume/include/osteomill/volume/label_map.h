#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// A label of a LabelMap: its value, its name and colour, and whether a burr may touch it.
struct Label {
  /// The value in the map's file.
  int value = 0;
  std::string name;
  /// Red, green, blue.
  std::array<std::uint8_t, 3> colour{};
  /// True for a structure that no burr may touch.
  bool no_go = false;
  friend bool operator==(const Label&, const Label&) = default;
};

/// Returns the colour as "#rrggbb".
std::string hex_colour(const Label& label);

/// Maps each voxel of a scan to its structure. Labels are names, not quantities: lookups use the nearest
/// voxel and never interpolate. Stored on the scan's grid, one byte per voxel of the box that bounds all
/// labels. Immutable; reading is safe in the haptic tick and from any thread.
class LabelMap {
 public:
  /// Index into `labels()`, counted from 1; 0 means no label.
  using LabelIndex = std::uint8_t;
  static constexpr std::size_t kMaxLabels = 255;

  /// Resamples labels from their own grid: `indices` has a value for each voxel of `own`, i fastest. Each
  /// voxel of `scan` gets the label of the nearest voxel of `own`, or none outside `own`. Throws
  /// std::invalid_argument for more than `kMaxLabels` labels, a wrong number of indices, or an index without
  /// a label.
  LabelMap(std::vector<Label> labels, const GridGeometry& scan, const GridGeometry& own,
           const std::vector<LabelIndex>& indices);

  const std::vector<Label>& labels() const { return labels_; }
  /// Returns the label with this index, which must not be 0.
  const Label& label(LabelIndex index) const { return labels_[index - 1u]; }
  /// Returns the label index of a voxel; 0 if it has no label or is outside the scan.
  LabelIndex at(const VoxelIndex& v) const noexcept {
    if (!box_.contains(v)) return 0;
    return indices_[row_major(dims_, v.i - box_.first.i, v.j - box_.first.j, v.k - box_.first.k)];
  }
  /// Returns the label index of the voxel nearest to any finite point of W.
  LabelIndex nearest_to(const Vec3& point_W) const noexcept;
  /// Returns the label index of the bone just below a surface point with this outward normal; 0 if none.
  /// Searches up to 1.5 voxels deep, because label maps often omit the bone's outermost voxels.
  LabelIndex under_surface(const Vec3& point_W, const Vec3& normal_W) const noexcept;

  /// Returns the number of voxels of the scan per label index; voxels without a label are not counted (entry
  /// 0 is 0). Passes over the voxels; not for the tick.
  std::vector<std::size_t> voxel_counts() const;

  /// Returns the bounding box of all labels; empty if there are none.
  const VoxelBox& box() const { return box_; }
  /// Returns the bounding box of all no-go labels; empty if there are none.
  const VoxelBox& no_go_box() const { return no_go_box_; }
  const GridGeometry& scan_geometry() const { return scan_; }
  /// Returns a hash that identifies the map. It depends on the labels' values and voxels, not on their names.
  std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  std::vector<Label> labels_;
  GridGeometry scan_;
  VoxelBox box_;
  VoxelBox no_go_box_;
  std::array<int, 3> dims_{0, 0, 0};
  std::vector<LabelIndex> indices_;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace osteomill
