#include "osteomill/volume/label_map.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

namespace {

VoxelBox labelled_box(const GridGeometry& own, const std::vector<LabelMap::LabelIndex>& indices) {
  VoxelBox box;
  std::size_t n = 0;
  for_each_with_progress(own.all_voxels(), [&](const VoxelIndex& v) {
    if (indices[n++] != 0) box.include(v);
  });
  return box;
}

int nearest(double voxel, int dim) {
  // Clamped so that distant points do not overflow int; both bounds are outside the grid.
  return static_cast<int>(std::lround(std::clamp(voxel, -2.0, static_cast<double>(dim) + 1)));
}

VoxelIndex nearest_voxel(const GridGeometry& geometry, const Vec3& point_W) {
  const Vec3 voxel = geometry.voxel_from_world(point_W);
  return {nearest(voxel.x(), geometry.dims[0]), nearest(voxel.y(), geometry.dims[1]),
          nearest(voxel.z(), geometry.dims[2])};
}

// Voxels of `scan` whose centres may be inside `voxels` of `own`.
VoxelBox covered(const GridGeometry& scan, const GridGeometry& own, const VoxelBox& voxels) {
  VoxelBox box;
  if (voxels.empty()) return box;
  for (unsigned n = 0; n < 8; ++n) {
    const Vec3 corner((n & 1) != 0 ? voxels.last.i + 0.5 : voxels.first.i - 0.5,
                      (n & 2) != 0 ? voxels.last.j + 0.5 : voxels.first.j - 0.5,
                      (n & 4) != 0 ? voxels.last.k + 0.5 : voxels.first.k - 0.5);
    box.include(nearest_voxel(scan, own.world_from_voxel(corner)));
  }
  return box.grown(1).intersected(scan.all_voxels());
}

}  // namespace

std::string hex_colour(const Label& label) {
  return fmt::format("#{:02x}{:02x}{:02x}", label.colour[0], label.colour[1], label.colour[2]);
}

LabelMap::LabelMap(std::vector<Label> labels, const GridGeometry& scan, const GridGeometry& own,
                   const std::vector<LabelIndex>& indices)
    : labels_(std::move(labels)), scan_(scan) {
  if (labels_.size() > kMaxLabels) throw std::invalid_argument("LabelMap: too many labels");
  if (indices.size() != own.voxel_count() ||
      std::any_of(indices.begin(), indices.end(), [&](LabelIndex index) { return index > labels_.size(); })) {
    throw std::invalid_argument("LabelMap: wrong number of indices, or an index without a label");
  }
  const VoxelBox own_voxels = own.all_voxels();
  const auto at_nearest = [&](const VoxelIndex& v) -> LabelIndex {
    const VoxelIndex in_own = nearest_voxel(own, scan.world_from_voxel(v));
    return own_voxels.contains(in_own) ? indices[row_major(own.dims, in_own.i, in_own.j, in_own.k)] : 0;
  };
  for_each_with_progress(covered(scan, own, labelled_box(own, indices)), [&](const VoxelIndex& v) {
    const LabelIndex index = at_nearest(v);
    if (index == 0) return;
    box_.include(v);
    if (label(index).no_go) no_go_box_.include(v);
  });
  if (box_.empty()) return;
  dims_ = box_.dims();
  indices_.reserve(cell_count(dims_));
  for_each_with_progress(box_, [&](const VoxelIndex& v) { indices_.push_back(at_nearest(v)); });
  WordHash hash;
  for (const VoxelIndex& corner : {box_.first, box_.last})
    for (const int n : {corner.i, corner.j, corner.k}) hash.add(static_cast<std::uint64_t>(n));
  for (const LabelIndex index : indices_)
    hash.add(index == 0 ? 0 : static_cast<std::uint64_t>(label(index).value));
  fingerprint_ = hash.value();
}

std::vector<std::size_t> LabelMap::voxel_counts() const {
  std::vector<std::size_t> counts(labels_.size() + 1);
  for (const LabelIndex index : indices_) ++counts[index];
  counts[0] = 0;
  return counts;
}

LabelMap::LabelIndex LabelMap::nearest_to(const Vec3& point_W) const noexcept {
  return at(nearest_voxel(scan_, point_W));
}

LabelMap::LabelIndex LabelMap::under_surface(const Vec3& point_W, const Vec3& normal_W) const noexcept {
  const double voxel_mm = scan_.spacing_mm.maxCoeff();
  for (const double voxels : {0.5, 0.0, 1.0, 1.5}) {
    const LabelIndex index = nearest_to(point_W - voxels * voxel_mm * normal_W);
    if (index != 0) return index;
  }
  return 0;
}

}  // namespace osteomill
