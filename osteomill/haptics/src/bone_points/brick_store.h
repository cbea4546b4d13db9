#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "bone_points/surface_lattice.h"

namespace osteomill {

/// The fine and coarse points of bricks, in a fixed number of slots. Copies are independent. Building
/// allocates; all else is safe in the haptic tick.
class BrickStore {
 public:
  static constexpr std::uint32_t kNoSlot = std::numeric_limits<std::uint32_t>::max();

  BrickStore() = default;
  /// Allocates for this number of bricks, and of chunks of their fine and coarse points.
  BrickStore(std::size_t slots, std::size_t fine_chunks, std::size_t coarse_chunks);

  const BrickPoints& fine() const { return fine_; }
  const BrickPoints& coarse() const { return coarse_; }
  /// Returns the brick stored in a slot.
  const VoxelIndex& brick(std::uint32_t slot) const { return slots_[slot].brick; }
  bool is_used(std::uint32_t slot) const { return fine_.brick(slot).count != 0; }
  /// Returns whether densities that its points depend on have fallen since it was built.
  bool is_stale(const SurfaceLattice& lattice, std::uint32_t slot) const {
    return slots_[slot].changes != lattice.changes_of(slots_[slot].brick);
  }
  /// Returns whether one more brick fits, however many points it has.
  bool has_free_space() const;

  /// Builds the points of a brick that has `slot`, or kNoSlot if it has none yet; it then takes a free one,
  /// which must exist. Frees the slot if the brick has no points. Returns the brick's occupancy.
  SurfaceLattice::Occupancy build(const SurfaceLattice& lattice, const VoxelIndex& brick,
                                  std::uint32_t& slot);
  /// While memory runs short, evicts bricks that are not `kept(brick)`, slot by slot in turn, and calls
  /// `evicted(brick)` for each.
  template <typename Kept, typename Evicted>
  void evict_far_bricks(const Kept& kept, const Evicted& evicted) {
    for (std::size_t n = 0; n < slots_.size() && is_nearly_full(); ++n) {
      const auto slot = static_cast<std::uint32_t>(next_to_evict_);
      next_to_evict_ = (next_to_evict_ + 1) % slots_.size();
      if (!is_used(slot) || kept(brick(slot))) continue;
      evicted(brick(slot));
      evict(slot);
    }
  }

 private:
  // The brick, the change counter of its densities when it was built, and its rows without bone.
  struct Slot {
    VoxelIndex brick;
    std::uint32_t changes = 0;
    SurfaceLattice::RowBits empty_rows{};
  };
  bool is_nearly_full() const;
  void evict(std::uint32_t slot);

  BrickPoints fine_;
  BrickPoints coarse_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_;
  std::size_t free_count_ = 0;
  std::size_t next_to_evict_ = 0;
  // Surface of the brick being built.
  SurfaceLattice::BrickSurface surface_;
};

}  // namespace osteomill
