#include "osteomill/surface/density_handover.h"

#include <algorithm>

#include "osteomill/numbers/row_major.h"

namespace osteomill {

DensityHandover::DensityHandover(const GridGeometry& geometry, std::size_t capacity)
    : voxel_dims_(geometry.dims), ring_(std::max<std::size_t>(capacity, 1)) {
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    brick_dims_[axis] = (voxel_dims_[axis] + kBrickVoxels - 1) / kBrickVoxels;
    count *= static_cast<std::size_t>(brick_dims_[axis]);
  }
  marked_.assign(count, 0);
  order_.assign(count, 0);
}

void DensityHandover::mark(const VolumeChange& change) noexcept {
  const VoxelBox& box = change.voxels;
  if (box.empty()) return;
  for (int bk = box.first.k / kBrickVoxels; bk <= box.last.k / kBrickVoxels; ++bk) {
    for (int bj = box.first.j / kBrickVoxels; bj <= box.last.j / kBrickVoxels; ++bj) {
      for (int bi = box.first.i / kBrickVoxels; bi <= box.last.i / kBrickVoxels; ++bi) {
        const auto number = static_cast<std::uint32_t>(row_major(brick_dims_, bi, bj, bk));
        if (marked_[number]) continue;
        marked_[number] = 1;
        order_[(next_ + waiting_) % order_.size()] = number;
        ++waiting_;
      }
    }
  }
}

void DensityHandover::send(const Volume& volume, std::size_t most) noexcept {
  const std::size_t sent = sent_.load(std::memory_order_relaxed);
  const std::size_t room = ring_.size() - (sent - received_.load(std::memory_order_acquire));
  const std::size_t count = std::min({most, room, waiting_});
  for (std::size_t n = 0; n < count; ++n) {
    const std::uint32_t number = order_[next_];
    next_ = (next_ + 1) % order_.size();
    --waiting_;
    marked_[number] = 0;
    copy_brick(volume.grid(), number, ring_[(sent + n) % ring_.size()]);
  }
  sent_.store(sent + count, std::memory_order_release);
}

void DensityHandover::copy_brick(const DensityGrid& grid, std::uint32_t number, Brick& brick) const noexcept {
  const auto [bi, bj, bk] = cell_at(brick_dims_, number);
  brick.first = {bi * kBrickVoxels, bj * kBrickVoxels, bk * kBrickVoxels};
  const VoxelIndex& first = brick.first;
  const int columns = std::min(kBrickVoxels, voxel_dims_[0] - first.i);
  const int rows = std::min(kBrickVoxels, voxel_dims_[1] - first.j);
  const int slices = std::min(kBrickVoxels, voxel_dims_[2] - first.k);
  for (int k = 0; k < slices; ++k) {
    for (int j = 0; j < rows; ++j) {
      const float* row = grid.densities().data() + grid.linear_index({first.i, first.j + j, first.k + k});
      std::copy_n(row, columns,
                  &brick.densities[static_cast<std::size_t>(kBrickVoxels * (j + kBrickVoxels * k))]);
    }
  }
}

const DensityHandover::Brick* DensityHandover::front() const noexcept {
  const std::size_t received = received_.load(std::memory_order_relaxed);
  if (received == sent_.load(std::memory_order_acquire)) return nullptr;
  return &ring_[received % ring_.size()];
}

void DensityHandover::pop() noexcept {
  received_.store(received_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

}  // namespace osteomill
