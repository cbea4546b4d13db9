#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/base/spsc_queue.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Sends copies of changed densities from the milling thread to a thread that keeps a copy of the volume. One
/// thread marks and sends, one receives, and neither ever waits. A brick that finds the queue full, or
/// exceeds the limit per tick, stays marked and is sent later with its densities at that time. Once
/// everything marked has been sent and received, both sides are equal.
class DensityHandover {
 public:
  /// 1 MiB: enough for all milling while the whole surface is meshed at a new isovalue.
  static constexpr std::size_t kMaxBricksInFlight = 511;

  /// Allocates the whole queue, for `capacity` bricks (or a few more) of 2 KiB.
  DensityHandover(const GridGeometry& geometry, std::size_t capacity);

  /// Marks changed voxels for sending. For the milling thread; safe in the haptic tick.
  void mark(const VolumeChange& change) noexcept;
  /// Copies up to `max` marked bricks, in the order in which they were marked. For the milling thread; safe
  /// in the haptic tick.
  void send(const Volume& volume, std::size_t max) noexcept;
  /// Returns the number of bricks marked but not sent. Any thread.
  std::size_t waiting_count() const noexcept { return waiting_.load(std::memory_order_acquire); }

  /// Returns the next brick, which the receiving thread may use until `pop`; null if the queue is empty.
  DensityBlock* front() noexcept { return in_flight_.front(); }
  void pop() noexcept { in_flight_.pop(); }

 private:
  std::array<int, 3> brick_dims_;

  // Marked bricks: a flag for each, and a ring of brick numbers in the order of marking.
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> order_;
  std::size_t next_ = 0;
  std::atomic<std::size_t> waiting_{0};

  SpscQueue<DensityBlock> in_flight_;
};

}  // namespace osteomill
