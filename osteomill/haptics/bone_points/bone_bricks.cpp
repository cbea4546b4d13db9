#include "osteomill/haptics/bone_points/bone_bricks.h"

#include <algorithm>

#include "osteomill/numbers/work_progress.h"
#include "osteomill/tool/milling_tool.h"

namespace osteomill {

namespace {

// Room for the bone near a tool with much to spare: of 200 000 to 800 000 points, 32 a chunk.
constexpr std::size_t kSlots = 16384;
constexpr std::size_t kFineChunks = 24576;
constexpr std::size_t kCoarseChunks = 16384;
// Kept free for what one tick makes.
constexpr std::size_t kSpareSlots = 2048;
constexpr std::size_t kSpareChunks = 4096;
// Bricks nearer than this to the tool are not forgotten.
constexpr double kKept_mm = 2;

// What looking at a brick costs, in points made: passed over, and for so many densities.
constexpr int kPassedOverCost = 2;
constexpr int kDensitiesLookedAt = 60;

}  // namespace

BoneBricks::BoneBricks(const Volume& volume, double spacing_mm, Points points)
    : lattice_(volume, spacing_mm),
      kinds_(points),
      octree_(lattice_.brick_dims()),
      fine_(kSlots, kFineChunks),
      coarse_(kSlots, points == Points::fine ? 0 : kCoarseChunks),
      brick_of_slot_(kSlots),
      changes_(kSlots),
      found_(std::make_unique<SurfaceLattice::BrickSurface>()) {
  const auto& dims = lattice_.brick_dims();
  slots_.resize(cell_count(dims), kNoPoints);
  for (int k = 0; k < dims[2]; ++k) {
    WorkProgress::done(static_cast<std::size_t>(k), static_cast<std::size_t>(dims[2]));
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i) {
        if (!lattice_.may_hold_surface({i, j, k})) continue;
        slots_[index_of({i, j, k})] = kUnmade;
        octree_.add(i, j, k, 1);
      }
    }
  }
  const double brick_mm = (lattice_.brick_nodes() * lattice_.step_mm()).norm();
  for (int level = 0; level < octree_.level_count(); ++level) {
    node_radii_mm_.push_back(0.5 * brick_mm * static_cast<double>(1 << level));
  }
  for (std::size_t n = kSlots; n-- > 0;) free_slots_.push_back(static_cast<std::uint32_t>(n));
}

Vec3 BoneBricks::node_middle_G(int level, int i, int j, int k) const {
  const double half = 0.5 * lattice_.brick_nodes() * static_cast<double>(1 << level);
  return lattice_.step_mm().cwiseProduct(half * Vec3(2 * i + 1, 2 * j + 1, 2 * k + 1) - Vec3::Ones());
}

std::uint32_t BoneBricks::slot_of(const VoxelIndex& brick) {
  const std::uint32_t& slot = slots_[index_of(brick)];
  if (slot == kUnmade && has_room()) make(brick);
  return slot == kEmptied || slot == kUnmade ? kNoPoints : slot;
}

// Makes a brick, or makes it anew; returns what it cost.
int BoneBricks::make(const VoxelIndex& brick) {
  std::uint32_t& slot = slots_[index_of(brick)];
  const std::uint32_t changes = lattice_.changes_of(brick);
  lattice_.find_surface(brick, *found_);
  const std::int32_t before = slot == kUnmade     ? 1
                              : slot == kNoPoints ? 0
                                                  : static_cast<std::int32_t>(fine_.brick(slot).count);
  if (slot == kUnmade) slot = kNoPoints;
  if (slot == kNoPoints && found_->fine_count > 0) {
    slot = free_slots_.back();
    free_slots_.pop_back();
    brick_of_slot_[slot] = brick;
  }
  std::int32_t after = 0;
  if (slot != kNoPoints) {
    changes_[slot] = changes;
    after = static_cast<std::int32_t>(fine_.replace(slot, {found_->fine.data(), found_->fine_count}));
    if (kinds_ == Points::fine_and_coarse) {
      SurfaceLattice::merge_flat_cells(*found_);
      coarse_.replace(slot, {found_->coarse.data(), found_->coarse_count});
    }
    if (after == 0) {
      free_slots_.push_back(slot);
      slot = kNoPoints;
    }
  }
  if (!found_->has_bone) slot = kEmptied;
  octree_.add(brick.i, brick.j, brick.k, after - before);
  return lattice_.densities_of_brick() / kDensitiesLookedAt + static_cast<int>(found_->fine_count);
}

void BoneBricks::refresh(const VoxelBox& voxels, int budget) {
  sweep_.wait_for(voxels);
  int spent = 0;
  while (spent < budget && (sweep_.is_walking() || start_sweep())) {
    spent += visit(sweep_.brick());
    sweep_.advance();
  }
}

bool BoneBricks::start_sweep() {
  const VoxelBox bricks = lattice_.bricks_touched_by(sweep_.take_waiting());
  if (bricks.empty()) return false;
  sweep_.start(bricks);
  return true;
}

// Bricks that had no surface come first: where it has moved into them it is found there before it is taken
// from where it was.
int BoneBricks::visit(const VoxelIndex& brick) {
  const std::uint32_t slot = slots_[index_of(brick)];
  if (slot == kUnmade || slot == kEmptied) return kPassedOverCost;
  if ((slot == kNoPoints) != sweep_.is_first_pass()) return kPassedOverCost;
  if (slot != kNoPoints) return changes_[slot] != lattice_.changes_of(brick) ? make(brick) : kPassedOverCost;
  if (!lattice_.may_hold_surface(brick)) return kPassedOverCost;
  if (has_room()) return make(brick);
  slots_[index_of(brick)] = kUnmade;
  octree_.add(brick.i, brick.j, brick.k, 1);
  return kPassedOverCost;
}

// For one more brick, however many points it has.
bool BoneBricks::has_room() const {
  constexpr std::size_t kMostChunks = SurfaceLattice::kMaxPointsOfBrick / PointChunk::kSlots + 1;
  return !free_slots_.empty() && fine_.free_chunks() >= kMostChunks &&
         (kinds_ == Points::fine || coarse_.free_chunks() >= kMostChunks);
}

void BoneBricks::make_room(const MillingTool& tool, const Pose& X_WT) {
  const Pose X_TW = X_WT.inverse();
  for (std::size_t n = 0; n < brick_of_slot_.size() && is_short_of_room(); ++n) {
    const std::uint32_t slot = static_cast<std::uint32_t>(next_to_forget_);
    next_to_forget_ = (next_to_forget_ + 1) % brick_of_slot_.size();
    if (fine_.brick(slot).count != 0 && !is_near(tool, X_TW, brick_of_slot_[slot])) forget(slot);
  }
}

bool BoneBricks::is_short_of_room() const {
  return free_slots_.size() < kSpareSlots || fine_.free_chunks() < kSpareChunks ||
         (kinds_ == Points::fine_and_coarse && coarse_.free_chunks() < kSpareChunks);
}

bool BoneBricks::is_near(const MillingTool& tool, const Pose& X_TW, const VoxelIndex& b) const {
  const Vec3 middle_W = lattice_.origin_W() + lattice_.direction() * node_middle_G(0, b.i, b.j, b.k);
  return tool_distance(tool, X_TW * middle_W).distance_mm < node_radius_mm(0) + kKept_mm;
}

void BoneBricks::forget(std::uint32_t slot) {
  const VoxelIndex& brick = brick_of_slot_[slot];
  octree_.add(brick.i, brick.j, brick.k, 1 - static_cast<std::int32_t>(fine_.brick(slot).count));
  fine_.replace(slot, {});
  if (kinds_ == Points::fine_and_coarse) coarse_.replace(slot, {});
  slots_[index_of(brick)] = kUnmade;
  free_slots_.push_back(slot);
}

}  // namespace osteomill
