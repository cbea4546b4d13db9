#include "bone_points/bone_bricks.h"

#include "bone_points/brick_kernel.h"

namespace osteomill {

namespace {

// Room for the bone near a tool with much to spare: of 200 000 to 800 000 points, 32 a chunk.
constexpr std::size_t kSlots = 16384;
constexpr std::size_t kFineChunks = 24576;
constexpr std::size_t kCoarseChunks = 16384;
// Bricks nearer than this to the tool are not forgotten.
constexpr double kKept_mm = 2;

// Cost of visiting a brick, in points built: of one that is skipped, and of each kDensitiesLookedAt densities
// that are sampled.
constexpr int kPassedOverCost = 2;
constexpr int kLookedAtCost = 4;
constexpr int kDensitiesLookedAt = 60;

std::uint32_t held_without_points(SurfaceLattice::Found found) {
  return found == SurfaceLattice::Found::no_bone ? BrickTree::kNoBone : BrickTree::kBoneAlone;
}

}  // namespace

BoneBricks::BoneBricks(const Volume& volume, double spacing_mm)
    : lattice_(volume, spacing_mm), tree_(lattice_.brick_dims()), store_(kSlots, kFineChunks, kCoarseChunks) {
  choose_point_instructions();
}

// Notes at an unseen place whether it may hold surface, if this tick may: a larger place then gets a node,
// and a brick stays unseen until it is made.
void BoneBricks::look(int level, const VoxelIndex& node, BrickTree::Place place) {
  if (tree_.held(place) != BrickTree::kUnseen || !queue_.may_make()) return;
  queue_.count_made(kLookedAtCost);
  const SurfaceLattice::Found found = lattice_.found_in(level, node);
  if (found != SurfaceLattice::Found::surface) {
    tree_.put(place, held_without_points(found));
  } else if (level > 0) {
    tree_.open(place);
  }
}

// Returns what making the slot's brick costs, in points.
int BoneBricks::cost_of(std::uint32_t slot) const {
  return lattice_.densities_of_brick() / kDensitiesLookedAt + static_cast<int>(fine().brick(slot).count);
}

// Makes a brick's points, also again; returns what it cost.
int BoneBricks::make_brick(const VoxelIndex& brick, BrickTree::Place place) {
  const std::uint32_t held = tree_.held(place);
  std::uint32_t slot = BrickTree::is_index(held) ? held : BrickStore::kNoSlot;
  const SurfaceLattice::Found found = store_.make(lattice_, brick, slot);
  if (slot != BrickStore::kNoSlot) {
    tree_.put(place, slot);
    return cost_of(slot);
  }
  tree_.put(place, held_without_points(found));
  return lattice_.densities_of_brick() / kDensitiesLookedAt;
}

// Bricks that are new come first: if the surface has moved on into another brick, it is found there before it
// is taken from where it was.
void BoneBricks::refresh(const VoxelBox& voxels, int others) noexcept {
  const VoxelBox bricks = lattice_.bricks_touched_by(voxels);
  for_each(bricks, [&](const VoxelIndex& brick) { others -= make_new(brick); });
  queue_.take_bearing_turns([&](std::uint32_t slot) { return cost_of(slot); },
                            [&](std::uint32_t slot) {
                              if (store_.is_used(slot)) remake(store_.brick(slot));
                            });
  queue_.add(bricks);
  int spent = 0;
  do {
    const std::optional<VoxelIndex> brick = queue_.next();
    if (!brick) break;
    spent += remake(*brick);
  } while (spent < others);
}

// Makes a brick that held bone alone and now has a surface; returns what it cost.
int BoneBricks::make_new(const VoxelIndex& brick) {
  const auto [place, level] = tree_.find(brick);
  if (tree_.held(place) != BrickTree::kBoneAlone ||
      lattice_.found_in(0, brick) != SurfaceLattice::Found::surface)
    return 0;
  if (level == 0 && store_.has_room()) return make_brick(brick, place);
  tree_.put(place, BrickTree::kUnseen);
  return kPassedOverCost;
}

// Makes a brick's points again if they are of other densities; returns what it cost.
int BoneBricks::remake(const VoxelIndex& brick) {
  const BrickTree::Place place = tree_.find(brick).first;
  const std::uint32_t held = tree_.held(place);
  if (!BrickTree::is_index(held) || !store_.is_stale(lattice_, held)) return kPassedOverCost;
  return make_brick(brick, place);
}

void BoneBricks::make_room(const MillingTool& tool, const Pose& X_WT) noexcept {
  const Pose X_TW = X_WT.inverse();
  const auto is_near = [&](const VoxelIndex& brick) {
    const Vec3 middle_W = lattice_.origin_W() + lattice_.direction() * lattice_.middle_G(0, brick);
    return tool_distance(tool, X_TW * middle_W).distance_mm < lattice_.radius_mm(0) + kKept_mm;
  };
  store_.make_room(is_near,
                   [&](const VoxelIndex& brick) { tree_.put(tree_.find(brick).first, BrickTree::kUnseen); });
  tree_.forget_nodes();
}

}  // namespace osteomill
