#include "bone_points/brick_store.h"

namespace osteomill {

namespace {

// Slots and chunks kept free for the bricks that one tick builds.
constexpr std::size_t kSpareSlots = 2048;
constexpr std::size_t kSpareChunks = 4096;

}  // namespace

BrickStore::BrickStore(std::size_t slots, std::size_t fine_chunks, std::size_t coarse_chunks)
    : fine_(slots, fine_chunks), coarse_(slots, coarse_chunks), slots_(slots), free_(slots) {
  for (std::size_t n = slots; n-- > 0;) free_[free_count_++] = static_cast<std::uint32_t>(n);
}

bool BrickStore::has_free_space() const {
  constexpr std::size_t kMaxChunks = SurfaceLattice::kMaxPointsOfBrick / PointChunk::kSlots + 1;
  return free_count_ > 0 && fine_.free_chunks() >= kMaxChunks && coarse_.free_chunks() >= kMaxChunks;
}

bool BrickStore::is_nearly_full() const {
  return free_count_ < kSpareSlots || fine_.free_chunks() < kSpareChunks ||
         coarse_.free_chunks() < kSpareChunks;
}

SurfaceLattice::Occupancy BrickStore::build(const SurfaceLattice& lattice, const VoxelIndex& brick,
                                            std::uint32_t& slot) {
  const std::uint32_t changes = lattice.changes_of(brick);
  SurfaceLattice::RowBits empty_rows{};
  if (slot != kNoSlot) empty_rows = slots_[slot].empty_rows;
  const SurfaceLattice::Occupancy occupancy = lattice.find_surface(brick, empty_rows, surface_);
  if (slot == kNoSlot) {
    if (surface_.fine.count == 0) return occupancy;
    slot = free_[--free_count_];
  }
  slots_[slot] = {brick, changes, empty_rows};
  fine_.replace(slot, surface_.fine);
  SurfaceLattice::merge_flat_cells(surface_);
  coarse_.replace(slot, surface_.coarse);
  if (!is_used(slot)) {
    free_[free_count_++] = slot;
    slot = kNoSlot;
  }
  return occupancy;
}

void BrickStore::evict(std::uint32_t slot) {
  fine_.replace(slot, PointRows{});
  coarse_.replace(slot, PointRows{});
  free_[free_count_++] = slot;
}

}  // namespace osteomill
