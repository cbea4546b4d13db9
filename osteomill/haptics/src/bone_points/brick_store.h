#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "bone_points/surface_lattice.h"

namespace osteomill {

/// The points of bricks, fine and coarse, in a fixed number of slots. A value: copies share nothing. Building
/// allocates; all else is safe in the haptic tick.
class BrickStore {
 public:
  static constexpr std::uint32_t kNoSlot = std::numeric_limits<std::uint32_t>::max();

  BrickStore() = default;
  /// Has room for this number of bricks, and of chunks of their fine and coarse points.
  BrickStore(std::size_t slots, std::size_t fine_chunks, std::size_t coarse_chunks);

  const BrickPoints& fine() const { return fine_; }
  const BrickPoints& coarse() const { return coarse_; }
  /// The brick whose points a slot holds.
  const VoxelIndex& brick(std::uint32_t slot) const { return slots_[slot].brick; }
  bool is_used(std::uint32_t slot) const { return fine_.brick(slot).count != 0; }
  /// Returns whether densities that its points are made from have fallen since they were made.
  bool is_stale(const SurfaceLattice& lattice, std::uint32_t slot) const {
    return slots_[slot].changes != lattice.changes_of(slots_[slot].brick);
  }
  /// Returns whether there is room for one more brick, however many points it has.
  bool has_room() const;

  /// Makes the points of a brick that has `slot`, or kNoSlot if it has none yet; it then takes one, for which
  /// there must be room, and gives it back if it has no points. Returns what was found.
  SurfaceLattice::Found make(const SurfaceLattice& lattice, const VoxelIndex& brick, std::uint32_t& slot);
  /// Makes room if little is left: forgets bricks that are not `kept(brick)`, slot by slot in turn, and calls
  /// `forgotten(brick)` for each.
  template <typename Kept, typename Forgotten>
  void make_room(const Kept& kept, const Forgotten& forgotten) {
    for (std::size_t n = 0; n < slots_.size() && is_short_of_room(); ++n) {
      const auto slot = static_cast<std::uint32_t>(next_to_forget_);
      next_to_forget_ = (next_to_forget_ + 1) % slots_.size();
      if (!is_used(slot) || kept(brick(slot))) continue;
      forgotten(brick(slot));
      forget(slot);
    }
  }

 private:
  // Holds the brick, the change counter of the densities from which its points were built, and the rows
  // without bone.
  struct Slot {
    VoxelIndex brick;
    std::uint32_t changes = 0;
    SurfaceLattice::RowBits without_bone{};
  };
  bool is_short_of_room() const;
  void forget(std::uint32_t slot);

  BrickPoints fine_;
  BrickPoints coarse_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_;
  std::size_t free_count_ = 0;
  std::size_t next_to_forget_ = 0;
  // The surface of the brick that is being made.
  SurfaceLattice::BrickSurface found_;
};

}  // namespace osteomill
