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
  /// A structure that no burr may touch.
  bool no_go = false;
  friend bool operator==(const Label&, const Label&) = default;
};

/// Returns the colour as "#rrggbb".
std::string hex_colour(const Label& label);

/// Maps each voxel of a scan to the structure that it belongs to. Labels are names, not quantities: they are
/// looked up at the nearest voxel and never interpolated. Kept on the scan's grid, a byte a voxel, in the box
/// that holds all labels. Does not change; reading is safe in the haptic tick and from any thread.
class LabelMap {
 public:
  /// The index of a label in `labels()`, counted from 1; 0 is no label.
  using LabelIndex = std::uint8_t;
  static constexpr std::size_t kMaxLabels = 255;

  /// Makes the map from labels on a grid of their own: `indices` has a value for each voxel of `own`, i
  /// running fastest. Each voxel of `scan` gets the label of the voxel of `own` that is nearest to its
  /// centre, none outside of `own`. Throws std::invalid_argument for more than `kMaxLabels` labels or indices
  /// that do not fit.
  LabelMap(std::vector<Label> labels, const GridGeometry& scan, const GridGeometry& own,
           const std::vector<LabelIndex>& indices);

  const std::vector<Label>& labels() const { return labels_; }
  /// Returns the label of this index, which is not 0.
  const Label& label(LabelIndex index) const { return labels_[index - 1u]; }
  /// Returns the index of the label at any voxel of the scan; 0 for none.
  LabelIndex at(const VoxelIndex& v) const noexcept {
    if (!box_.contains(v)) return 0;
    return indices_[row_major(dims_, v.i - box_.first.i, v.j - box_.first.j, v.k - box_.first.k)];
  }
  /// Returns the index of the label at the voxel nearest to any finite point of W.
  LabelIndex nearest_to(const Vec3& point_W) const noexcept;
  /// Returns the label of the bone just under a place of its surface with this normal. Looks up to 1.5 voxels
  /// deep, since label maps often leave out the bone's outermost voxels.
  LabelIndex under_surface(const Vec3& point_W, const Vec3& normal_W) const noexcept;

  /// Returns how many voxels of the scan have each label, by the label's index; voxels without a label are
  /// not counted. Goes through all voxels; not for the tick.
  std::vector<std::size_t> voxel_counts() const;

  /// Returns the box that holds all labels; empty if there are none.
  const VoxelBox& box() const { return box_; }
  /// Returns the box that holds all no-go labels; empty if there are none.
  const VoxelBox& no_go_box() const { return no_go_box_; }
  const GridGeometry& scan_geometry() const { return scan_; }
  /// Returns a number that two label maps hardly share. It follows from where values lie, not from the
  /// labels' names.
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
