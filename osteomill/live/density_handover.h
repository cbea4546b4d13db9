#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/numbers/spsc_queue.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Copies of changed densities on their way from the thread that mills to one that keeps a copy of the
/// volume. One thread marks and sends, one receives, and neither ever waits. What finds no room, or exceeds
/// what a tick may copy, stays marked and is sent later as it is then, so that once everything marked has
/// been sent and received both sides are the same.
class DensityHandover {
 public:
  /// Room for `capacity` bricks (or a few more) on their way, 2 KiB each. Allocates everything.
  DensityHandover(const GridGeometry& geometry, std::size_t capacity);

  /// The milling thread: what changed has to be sent. Safe in the haptic tick.
  void mark(const VolumeChange& change) noexcept;
  /// The milling thread: copies up to `max` of the bricks marked, the longest marked first. Safe in the
  /// haptic tick.
  void send(const Volume& volume, std::size_t max) noexcept;
  /// How many bricks are marked and not sent. From any thread: those it does not count can be received.
  std::size_t waiting() const noexcept { return waiting_.load(std::memory_order_acquire); }

  /// The receiving thread: the next brick, its own until `pop`; null where there is none.
  DensityBlock* front() noexcept { return on_their_way_.front(); }
  void pop() noexcept { on_their_way_.pop(); }

 private:
  std::array<int, 3> brick_dims_;

  // Bricks marked: a flag each, and their numbers in a ring in the order in which they were marked.
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> order_;
  std::size_t next_ = 0;
  std::atomic<std::size_t> waiting_{0};

  SpscQueue<DensityBlock> on_their_way_;
};

}  // namespace osteomill
