#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/volume/volume.h"

namespace osteomill {

/// Copies of changed densities on their way from the thread that mills to one that keeps a copy of the
/// volume, in bricks of 8 x 8 x 8 voxels. One thread marks and sends, one receives, and neither ever waits.
/// What finds no room, or exceeds what a tick may copy, stays marked and is sent later as it is then, so that
/// once everything marked has been sent and received both sides are the same.
class DensityHandover {
 public:
  static constexpr int kBrickVoxels = 8;
  struct Brick {
    /// The least voxel; the brick may reach beyond the grid, where its densities mean nothing.
    VoxelIndex first;
    /// Along i fastest.
    std::array<float, static_cast<std::size_t>(kBrickVoxels* kBrickVoxels* kBrickVoxels)> densities;
  };

  /// Room for `capacity` bricks (at least one) on their way, 2 KiB each. Allocates everything.
  explicit DensityHandover(const GridGeometry& geometry, std::size_t capacity);

  /// The milling thread: what changed has to be sent. Safe in the haptic tick.
  void mark(const VolumeChange& change) noexcept;
  /// The milling thread: copies up to `most` of the bricks marked, the longest marked first. Safe in the
  /// haptic tick.
  void send(const Volume& volume, std::size_t most) noexcept;
  /// The milling thread: how many bricks are marked and not sent.
  std::size_t waiting() const noexcept { return waiting_; }

  /// The receiving thread: the next brick, until `pop`; null where there is none.
  const Brick* front() const noexcept;
  void pop() noexcept;

 private:
  void copy_brick(const DensityGrid& grid, std::uint32_t number, Brick& brick) const noexcept;

  std::array<int, 3> voxel_dims_;
  std::array<int, 3> brick_dims_;

  // Bricks marked: a flag each, and their numbers in a ring in the order in which they were marked.
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> order_;
  std::size_t next_ = 0;
  std::size_t waiting_ = 0;

  // Bricks on their way, in a ring. Counts of bricks since the start; each is written by one thread.
  std::vector<Brick> ring_;
  std::atomic<std::size_t> sent_{0};
  std::atomic<std::size_t> received_{0};
};

}  // namespace osteomill
