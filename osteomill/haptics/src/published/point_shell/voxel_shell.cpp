#include "published/point_shell/voxel_shell.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "osteomill/base/bits_above.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::point_shell {

namespace {

// Spare capacity for surface that milling exposes: as much again as the initial surface, plus this (32 points
// per chunk).
constexpr std::size_t kSpareChunks = 8192;
constexpr int kSide = VoxelShell::kBrickNodes;

template <std::size_t N>
std::size_t count_of(const std::array<std::uint8_t, N>& mask) {
  std::size_t count = 0;
  for (const std::uint8_t byte : mask) count += static_cast<std::size_t>(std::popcount(byte));
  return count;
}

GridGeometry coarser(const GridGeometry& voxels, int stride) {
  GridGeometry nodes = voxels;
  nodes.origin_mm = voxels.world_from_voxel(Vec3::Constant(0.5 * (stride - 1)).eval());
  nodes.spacing_mm = stride * voxels.spacing_mm;
  for (int& dim : nodes.dims) dim = (dim + stride - 1) / stride;
  return nodes;
}

}  // namespace

VoxelShell::VoxelShell(const Volume& volume, int scale)
    : volume_(&volume),
      stride_(scale),
      geometry_(coarser(volume.geometry(), scale)),
      point_area_mm2_(static_cast<float>(std::pow(geometry_.voxel_volume_mm3(), 2.0 / 3.0))),
      brick_side_mm_(kSide * geometry_.spacing_mm),
      bone_above_(largest_float_up_to(volume.isovalue())),
      bone_(geometry_.dims) {
  const auto& dims = geometry_.dims;
  for (int k = 0; k < dims[2]; ++k) {
    WorkProgress::done(0);
    for (int j = 0; j < dims[1]; ++j) {
      for (int byte = 0; 8 * byte < dims[0]; ++byte) bone_.set_byte(byte, j, k, bone_byte(byte, j, k));
    }
  }
  bricks_ = geometry_.all_voxels().bricks(kSide);
  while (bricks_.bricks(1 << root_level_).dims() != std::array{1, 1, 1}) ++root_level_;
  masks_.resize(cell_count(bricks_.dims()));
  std::size_t chunks = 0;
  {
    const WorkProgress::Part counting(0.4);
    for_each_with_progress(bricks_, [&](const VoxelIndex& b) {
      chunks += (count_of(mask_of(b)) + PointChunk::kSlots - 1) / PointChunk::kSlots;
    });
  }
  {
    const WorkProgress::Part making_room(0.6);
    points_ = BrickPoints(masks_.size(), 2 * chunks + kSpareChunks);
  }
  const WorkProgress::Part placing(1);
  for_each_with_progress(bricks_, [&](const VoxelIndex& b) { refresh_brick(b); });
}

void VoxelShell::refresh(const VoxelBox& voxels) {
  const VoxelBox nodes = nodes_touched_by(voxels);
  if (nodes.empty()) return;
  clear_milled_nodes(nodes);
  for_each(nodes.grown(1).intersected(geometry_.all_voxels()).bricks(kSide),
           [&](const VoxelIndex& brick) { refresh_brick(brick); });
}

// Returns the bone bits of nodes 8 * `byte` to 8 * `byte` + 7 of row j of slice k, the first in the lowest
// bit.
std::uint8_t VoxelShell::bone_byte(int byte, int j, int k) const {
  const int first = 8 * byte;
  const int count = std::min(8, geometry_.dims[0] - first);
  const DensityGrid& grid = volume_->grid();
  if (stride_ == 1 && count == 8) {
    const float* row = grid.address_of({first, j, k});
    return static_cast<std::uint8_t>(bits_above(row, 8, bone_above_));
  }
  unsigned bits = 0;
  for (int n = 0; n < count; ++n) {
    const Vec3 voxel = stride_ * Vec3(first + n, j, k) + Vec3::Constant(0.5 * (stride_ - 1));
    const double density =
        stride_ == 1 ? static_cast<double>(grid[{first + n, j, k}]) : density_at_voxel(grid, voxel);
    bits |= static_cast<unsigned>(density > volume_->isovalue()) << n;
  }
  return static_cast<std::uint8_t>(bits);
}

// Densities only fall, so bytes without bone are skipped.
void VoxelShell::clear_milled_nodes(const VoxelBox& nodes) {
  for (int k = nodes.first.k; k <= nodes.last.k; ++k) {
    for (int j = nodes.first.j; j <= nodes.last.j; ++j) {
      for (int byte = nodes.first.i / 8; byte <= nodes.last.i / 8; ++byte) {
        const std::uint8_t before = bone_.byte(byte, j, k);
        if (before != 0) bone_.set_byte(byte, j, k, before & bone_byte(byte, j, k));
      }
    }
  }
}

// Returns the nodes whose density depends on voxels in `voxels`.
VoxelBox VoxelShell::nodes_touched_by(const VoxelBox& voxels) const {
  if (voxels.empty()) return voxels;
  // A node is (stride - 1) / 2 voxels into its stride and reads the voxels on both sides.
  const int s = stride_, before = s / 2, after = (s - 1) / 2;
  const auto first = [&](int v) { return v < before ? 0 : (v - before) / s; };
  const auto last = [&](int v) { return s == 1 ? v : (v < after ? 0 : (v - after) / s + 1); };
  const VoxelBox nodes{{first(voxels.first.i), first(voxels.first.j), first(voxels.first.k)},
                       {last(voxels.last.i), last(voxels.last.j), last(voxels.last.k)}};
  return nodes.intersected(geometry_.all_voxels());
}

VoxelShell::SurfaceMask VoxelShell::mask_of(const VoxelIndex& b) const {
  SurfaceMask mask{};
  const int end_j = std::min(kSide, geometry_.dims[1] - kSide * b.j);
  const int end_k = std::min(kSide, geometry_.dims[2] - kSide * b.k);
  for (int k = 0; k < end_k; ++k) {
    for (int j = 0; j < end_j; ++j) {
      mask[static_cast<std::size_t>(j + kSide * k)] =
          bone_.surface_byte(b.i, kSide * b.j + j, kSide * b.k + k);
    }
  }
  return mask;
}

void VoxelShell::refresh_brick(const VoxelIndex& b) {
  const std::size_t brick = brick_index(b);
  const SurfaceMask mask = mask_of(b);
  if (mask == masks_[brick]) return;
  masks_[brick] = mask;
  found_.count = 0;
  for (std::size_t row = 0; row < mask.size(); ++row) {
    for (unsigned bits = mask[row]; bits != 0; bits &= bits - 1) {
      const Vec3 node(std::countr_zero(bits), static_cast<double>(row % kSide),
                      static_cast<double>(row / kSide));
      const Eigen::Vector3f at_mm = geometry_.spacing_mm.cwiseProduct(node).cast<float>();
      found_.add({at_mm.x(), at_mm.y(), at_mm.z(), point_area_mm2_});
    }
  }
  points_.replace(brick, found_);
}

}  // namespace osteomill::point_shell
