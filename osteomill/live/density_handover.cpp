#include "osteomill/live/density_handover.h"

#include <algorithm>

#include "osteomill/device/spsc_queue.h"

namespace osteomill {

namespace {

constexpr int kSide = DensityBlock::kVoxels;

}  // namespace

DensityHandover::DensityHandover(const GridGeometry& geometry, std::size_t capacity)
    : on_their_way_(std::make_unique<SpscQueue<DensityBlock>>(std::max<std::size_t>(capacity, 1))) {
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    brick_dims_[axis] = (geometry.dims[axis] + kSide - 1) / kSide;
    count *= static_cast<std::size_t>(brick_dims_[axis]);
  }
  marked_.assign(count, 0);
  order_.assign(count, 0);
}

DensityHandover::~DensityHandover() = default;

void DensityHandover::mark(const VolumeChange& change) noexcept {
  const VoxelBox& box = change.voxels;
  if (box.empty()) return;
  std::size_t waiting = waiting_.load(std::memory_order_relaxed);
  for (int bk = box.first.k / kSide; bk <= box.last.k / kSide; ++bk) {
    for (int bj = box.first.j / kSide; bj <= box.last.j / kSide; ++bj) {
      for (int bi = box.first.i / kSide; bi <= box.last.i / kSide; ++bi) {
        const auto number = static_cast<std::uint32_t>(bi + brick_dims_[0] * (bj + brick_dims_[1] * bk));
        if (marked_[number]) continue;
        marked_[number] = 1;
        order_[(next_ + waiting) % order_.size()] = number;
        ++waiting;
      }
    }
  }
  waiting_.store(waiting, std::memory_order_release);
}

void DensityHandover::send(const Volume& volume, std::size_t max) noexcept {
  std::size_t waiting = waiting_.load(std::memory_order_relaxed);
  for (std::size_t n = 0; n < max && waiting > 0; ++n) {
    const std::uint32_t number = order_[next_];
    if (!on_their_way_->try_push(volume.grid(), first_voxel(number))) break;
    next_ = (next_ + 1) % order_.size();
    --waiting;
    marked_[number] = 0;
  }
  waiting_.store(waiting, std::memory_order_release);
}

VoxelIndex DensityHandover::first_voxel(std::uint32_t number) const noexcept {
  const int plain = static_cast<int>(number);
  return {plain % brick_dims_[0] * kSide, plain / brick_dims_[0] % brick_dims_[1] * kSide,
          plain / brick_dims_[0] / brick_dims_[1] * kSide};
}

DensityBlock* DensityHandover::front() noexcept {
  return on_their_way_->front();
}

void DensityHandover::pop() noexcept {
  on_their_way_->pop();
}

}  // namespace osteomill
