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

/// Copies of changed densities on their way from the thread that mills to one that keeps a copy of the
/// volume. One thread marks and sends, one receives, and neither ever waits. A brick that finds no room, or
/// exceeds what a tick may copy, stays marked and is sent later as it is then, so that once everything marked
/// has been sent and received both sides are the same.
class DensityHandover {
 public:
  /// 1 MiB: enough for all that is milled while the whole surface is meshed at a new isovalue.
  static constexpr std::size_t kMaxBricksInFlight = 511;

  /// Makes room for `capacity` bricks (or a few more) on their way, 2 KiB each. Allocates everything.
  DensityHandover(const GridGeometry& geometry, std::size_t capacity);

  /// Marks what changed to be sent. For the milling thread; safe in the haptic tick.
  void mark(const VolumeChange& change) noexcept;
  /// Copies up to `max` of the bricks marked, the longest marked first. For the milling thread; safe in the
  /// haptic tick.
  void send(const Volume& volume, std::size_t max) noexcept;
  /// Returns how many bricks are marked and not sent; all others can be received. From any thread.
  std::size_t waiting_count() const noexcept { return waiting_.load(std::memory_order_acquire); }

  /// Returns the next brick, the receiving thread's own until `pop`; null if there is none.
  DensityBlock* front() noexcept { return in_flight_.front(); }
  void pop() noexcept { in_flight_.pop(); }

 private:
  std::array<int, 3> brick_dims_;

  // Bricks marked: a flag each, and their numbers in a ring in the order in which they were marked.
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> order_;
  std::size_t next_ = 0;
  std::atomic<std::size_t> waiting_{0};

  SpscQueue<DensityBlock> in_flight_;
};

}  // namespace osteomill
