#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "osteomill/base/pose.h"
#include "osteomill/base/row_major.h"
#include "osteomill/base/work_progress.h"

namespace osteomill {

/// A voxel of a grid: column i, row j, slice k, each from 0.
struct VoxelIndex {
  int i = 0;
  int j = 0;
  int k = 0;
  friend bool operator==(const VoxelIndex&, const VoxelIndex&) = default;
};

/// Box of voxels; both corners are inclusive. Empty if `last` is below `first` along any axis.
struct VoxelBox {
  VoxelIndex first{0, 0, 0};
  VoxelIndex last{-1, -1, -1};

  friend bool operator==(const VoxelBox&, const VoxelBox&) = default;
  bool empty() const { return last.i < first.i || last.j < first.j || last.k < first.k; }
  bool contains(const VoxelIndex& v) const {
    return v.i >= first.i && v.i <= last.i && v.j >= first.j && v.j <= last.j && v.k >= first.k &&
           v.k <= last.k;
  }
  /// Grows the box so that it contains `v`.
  void include(const VoxelIndex& v) {
    if (empty()) {
      first = last = v;
      return;
    }
    first = {std::min(first.i, v.i), std::min(first.j, v.j), std::min(first.k, v.k)};
    last = {std::max(last.i, v.i), std::max(last.j, v.j), std::max(last.k, v.k)};
  }
  /// Returns the box grown by `voxels` on every side (an empty box stays empty).
  VoxelBox grown(int voxels) const {
    if (empty()) return *this;
    return {{first.i - voxels, first.j - voxels, first.k - voxels},
            {last.i + voxels, last.j + voxels, last.k + voxels}};
  }
  /// Returns the intersection with `other`.
  VoxelBox intersected(const VoxelBox& other) const {
    return {{std::max(first.i, other.first.i), std::max(first.j, other.first.j),
             std::max(first.k, other.first.k)},
            {std::min(last.i, other.last.i), std::min(last.j, other.last.j), std::min(last.k, other.last.k)}};
  }
  /// Returns the number of voxels along each axis. The box must not be empty.
  std::array<int, 3> dims() const {
    return {last.i - first.i + 1, last.j - first.j + 1, last.k - first.k + 1};
  }
  /// Returns the bricks of `side` voxels, counted from voxel 0, that the box overlaps, as a box of brick
  /// coordinates. The box must not have negative coordinates.
  VoxelBox bricks(int side) const {
    if (empty()) return {};
    return {{first.i / side, first.j / side, first.k / side}, {last.i / side, last.j / side, last.k / side}};
  }
  /// Returns the voxels of a brick of `side` voxels.
  static VoxelBox of_brick(const VoxelIndex& brick, int side) {
    const VoxelIndex first{brick.i * side, brick.j * side, brick.k * side};
    return {first, {first.i + side - 1, first.j + side - 1, first.k + side - 1}};
  }
};

/// Calls `use` with every voxel (or brick) of the box, i fastest.
template <typename Use>
void for_each(const VoxelBox& box, const Use& use) {
  for (int k = box.first.k; k <= box.last.k; ++k) {
    for (int j = box.first.j; j <= box.last.j; ++j) {
      for (int i = box.first.i; i <= box.last.i; ++i) use(VoxelIndex{i, j, k});
    }
  }
}

/// Like `for_each`, but reports progress before each slice (WorkProgress): for long work.
template <typename Use>
void for_each_with_progress(const VoxelBox& box, const Use& use) {
  for (int k = box.first.k; k <= box.last.k; ++k) {
    WorkProgress::done(static_cast<std::size_t>(k - box.first.k), static_cast<std::size_t>(box.dims()[2]));
    for_each({{box.first.i, box.first.j, k}, {box.last.i, box.last.j, k}}, use);
  }
}

/// Pose and size of a voxel grid in the world frame W (the scan's patient axes, mm). Voxel coordinates are
/// continuous: the centre of voxel (i, j, k) is at (i, j, k).
struct GridGeometry {
  std::array<int, 3> dims{0, 0, 0};
  /// Distance between neighbouring voxel centres along i, j, k.
  Vec3 spacing_mm = Vec3::Ones();
  /// Centre of voxel (0, 0, 0) in W.
  Vec3 origin_mm = Vec3::Zero();
  /// Columns: unit directions of i, j, k in W; orthogonal, right- or left-handed.
  Mat3 direction = Mat3::Identity();

  std::size_t voxel_count() const { return cell_count(dims); }
  VoxelBox all_voxels() const { return {{0, 0, 0}, {dims[0] - 1, dims[1] - 1, dims[2] - 1}}; }
  double voxel_volume_mm3() const { return spacing_mm.prod(); }

  /// Converts continuous voxel coordinates to a point in W, mm.
  Vec3 world_from_voxel(const Vec3& voxel) const {
    return origin_mm + direction * spacing_mm.cwiseProduct(voxel);
  }
  Vec3 world_from_voxel(const VoxelIndex& v) const { return world_from_voxel(Vec3(v.i, v.j, v.k)); }
  /// Converts a point in W, mm, to continuous voxel coordinates.
  Vec3 voxel_from_world(const Vec3& point_W) const {
    return (direction.transpose() * (point_W - origin_mm)).cwiseQuotient(spacing_mm);
  }
};

}  // namespace osteomill
