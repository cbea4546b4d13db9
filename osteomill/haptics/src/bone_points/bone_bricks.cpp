#include "bone_points/bone_bricks.h"

#include "bone_points/brick_kernel.h"

namespace osteomill {

namespace {

// Capacity for the bone near a tool with a large margin: 200 000 to 800 000 points, 32 per chunk.
constexpr std::size_t kSlots = 16384;
constexpr std::size_t kFineChunks = 24576;
constexpr std::size_t kCoarseChunks = 16384;
// Distance from the tool, mm, within which bricks are not evicted.
constexpr double kKeepDistance_mm = 2;

// Costs, in points built: skipping a brick, and classifying a node. Sampling kDensitiesPerPoint densities
// costs as much as one point.
constexpr int kSkipCost = 2;
constexpr int kClassifyCost = 4;
constexpr int kDensitiesPerPoint = 60;

std::uint32_t content_without_points(SurfaceLattice::Occupancy occupancy) {
  return occupancy == SurfaceLattice::Occupancy::no_bone ? BrickTree::kNoBone : BrickTree::kAllBone;
}

}  // namespace

BoneBricks::BoneBricks(const Volume& volume, double spacing_mm, double tick_s)
    : lattice_(volume, spacing_mm),
      tree_(lattice_.brick_dims()),
      store_(kSlots, kFineChunks, kCoarseChunks),
      queue_(tick_s) {
  choose_point_instructions();
}

// Classifies an unknown entry, within this tick's budget. An entry above the bricks that may contain surface
// gets a node; a brick stays unknown until it is built.
void BoneBricks::classify(int level, const VoxelIndex& node, BrickTree::EntryIndex entry) {
  if (tree_.content(entry) != BrickTree::kUnknown || !queue_.has_build_budget()) return;
  queue_.spend_build_budget(kClassifyCost);
  const SurfaceLattice::Occupancy occupancy = lattice_.occupancy_of(level, node);
  if (occupancy != SurfaceLattice::Occupancy::surface) {
    tree_.set_content(entry, content_without_points(occupancy));
  } else if (level > 0) {
    tree_.add_node(entry);
  }
}

// Returns the cost of building the slot's brick, in points.
int BoneBricks::cost_of(std::uint32_t slot) const {
  return lattice_.densities_of_brick() / kDensitiesPerPoint + static_cast<int>(fine().brick(slot).count);
}

// Builds or rebuilds a brick's points. Returns the cost, in points.
int BoneBricks::build_brick(const VoxelIndex& brick, BrickTree::EntryIndex entry) {
  const std::uint32_t content = tree_.content(entry);
  std::uint32_t slot = BrickTree::is_index(content) ? content : BrickStore::kNoSlot;
  const SurfaceLattice::Occupancy occupancy = store_.build(lattice_, brick, slot);
  if (slot != BrickStore::kNoSlot) {
    tree_.set_content(entry, slot);
    return cost_of(slot);
  }
  tree_.set_content(entry, content_without_points(occupancy));
  return lattice_.densities_of_brick() / kDensitiesPerPoint;
}

// Builds exposed bricks first: if the surface has moved into another brick, it must appear there before it
// disappears from the old one.
void BoneBricks::refresh(const VoxelBox& voxels, int others) noexcept {
  const VoxelBox bricks = lattice_.bricks_touched_by(voxels);
  for_each(bricks, [&](const VoxelIndex& brick) { others -= build_exposed(brick); });
  queue_.update_supporting_in_turns([&](std::uint32_t slot) { return cost_of(slot); },
                                    [&](std::uint32_t slot) {
                                      if (store_.is_used(slot)) rebuild_if_stale(store_.brick(slot));
                                    });
  queue_.add(bricks);
  int spent = 0;
  do {
    const std::optional<VoxelIndex> brick = queue_.next();
    if (!brick) break;
    spent += rebuild_if_stale(*brick);
  } while (spent < others);
}

// Builds a brick that was all bone and now has a surface. Returns the cost, in points.
int BoneBricks::build_exposed(const VoxelIndex& brick) {
  const auto [entry, level] = tree_.find(brick);
  if (tree_.content(entry) != BrickTree::kAllBone ||
      lattice_.occupancy_of(0, brick) != SurfaceLattice::Occupancy::surface)
    return 0;
  if (level == 0 && store_.has_free_space()) return build_brick(brick, entry);
  tree_.set_content(entry, BrickTree::kUnknown);
  return kSkipCost;
}

// Rebuilds a brick's points if its densities have changed. Returns the cost, in points.
int BoneBricks::rebuild_if_stale(const VoxelIndex& brick) {
  const BrickTree::EntryIndex entry = tree_.find(brick).first;
  const std::uint32_t content = tree_.content(entry);
  if (!BrickTree::is_index(content) || !store_.is_stale(lattice_, content)) return kSkipCost;
  return build_brick(brick, entry);
}

void BoneBricks::evict_far_bricks(const MillingTool& tool, const Pose& X_WT) noexcept {
  const Pose X_TW = X_WT.inverse();
  const auto is_near = [&](const VoxelIndex& brick) {
    const Vec3 middle_W = lattice_.origin_W() + lattice_.direction() * lattice_.middle_G(0, brick);
    return tool_distance(tool, X_TW * middle_W).distance_mm < lattice_.radius_mm(0) + kKeepDistance_mm;
  };
  store_.evict_far_bricks(is_near, [&](const VoxelIndex& brick) {
    tree_.set_content(tree_.find(brick).first, BrickTree::kUnknown);
  });
  tree_.evict_nodes();
}

}  // namespace osteomill
