#include "density_handover.h"

#include <algorithm>

namespace osteomill {

DensityHandover::DensityHandover(const GridGeometry& geometry, std::size_t capacity)
    : brick_dims_(geometry.all_voxels().bricks(DensityBlock::kVoxels).dims()),
      marked_(cell_count(brick_dims_)),
      order_(cell_count(brick_dims_)),
      in_flight_(std::max<std::size_t>(capacity, 1)) {}

void DensityHandover::mark(const VolumeChange& change) noexcept {
  const VoxelBox& box = change.voxels;
  if (box.empty()) return;
  std::size_t waiting = waiting_.load(std::memory_order_relaxed);
  for_each(box.bricks(DensityBlock::kVoxels), [&](const VoxelIndex& brick) {
    const auto number = static_cast<std::uint32_t>(row_major(brick_dims_, brick.i, brick.j, brick.k));
    if (marked_[number]) return;
    marked_[number] = 1;
    order_[(next_ + waiting) % order_.size()] = number;
    ++waiting;
  });
  waiting_.store(waiting, std::memory_order_release);
}

void DensityHandover::send(const Volume& volume, std::size_t max) noexcept {
  std::size_t waiting = waiting_.load(std::memory_order_relaxed);
  for (std::size_t n = 0; n < max && waiting > 0; ++n) {
    const std::uint32_t number = order_[next_];
    const auto [bi, bj, bk] = cell_at(brick_dims_, number);
    const VoxelBox voxels = VoxelBox::of_brick({bi, bj, bk}, DensityBlock::kVoxels);
    if (!in_flight_.try_push(volume.grid(), voxels.first)) break;
    next_ = (next_ + 1) % order_.size();
    --waiting;
    marked_[number] = 0;
  }
  waiting_.store(waiting, std::memory_order_release);
}

}  // namespace osteomill
