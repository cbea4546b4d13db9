#include "bone_points/brick_store.h"

namespace osteomill {

namespace {

// Kept free for what one tick makes.
constexpr std::size_t kSpareSlots = 2048;
constexpr std::size_t kSpareChunks = 4096;

}  // namespace

BrickStore::BrickStore(std::size_t slots, std::size_t fine_chunks, std::size_t coarse_chunks)
    : fine_(slots, fine_chunks), coarse_(slots, coarse_chunks), slots_(slots), free_(slots) {
  for (std::size_t n = slots; n-- > 0;) free_[free_count_++] = static_cast<std::uint32_t>(n);
}

bool BrickStore::has_room() const {
  constexpr std::size_t kMostChunks = SurfaceLattice::kMaxPointsOfBrick / PointChunk::kSlots + 1;
  return free_count_ > 0 && fine_.free_chunks() >= kMostChunks && coarse_.free_chunks() >= kMostChunks;
}

bool BrickStore::is_short_of_room() const {
  return free_count_ < kSpareSlots || fine_.free_chunks() < kSpareChunks ||
         coarse_.free_chunks() < kSpareChunks;
}

SurfaceLattice::Found BrickStore::make(const SurfaceLattice& lattice, const VoxelIndex& brick,
                                       std::uint32_t& slot) {
  const std::uint32_t changes = lattice.changes_of(brick);
  SurfaceLattice::RowBits without_bone{};
  if (slot != kNoSlot) without_bone = slots_[slot].without_bone;
  const SurfaceLattice::Found found = lattice.find_surface(brick, without_bone, found_);
  if (slot == kNoSlot) {
    if (found_.fine.count == 0) return found;
    slot = free_[--free_count_];
  }
  slots_[slot] = {brick, changes, without_bone};
  fine_.replace(slot, found_.fine);
  SurfaceLattice::merge_flat_cells(found_);
  coarse_.replace(slot, found_.coarse);
  if (!is_used(slot)) {
    free_[free_count_++] = slot;
    slot = kNoSlot;
  }
  return found;
}

void BrickStore::forget(std::uint32_t slot) {
  fine_.replace(slot, PointRows{});
  coarse_.replace(slot, PointRows{});
  free_[free_count_++] = slot;
}

}  // namespace osteomill
