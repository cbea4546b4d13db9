#include "bone_points/bone_bricks.h"

#include <algorithm>

#include "osteomill/haptics/milling_tool.h"

namespace osteomill {

namespace {

// Room for the bone near a tool with much to spare: of 200 000 to 800 000 points, 32 a chunk.
constexpr std::size_t kSlots = 16384;
constexpr std::size_t kFineChunks = 24576;
constexpr std::size_t kCoarseChunks = 16384;
// Kept free for what one tick makes.
constexpr std::size_t kSpareSlots = 2048;
constexpr std::size_t kSpareChunks = 4096;
// Of the octree, and how many are looked at a tick for one to forget.
constexpr std::size_t kNodes = 32768;
constexpr std::size_t kSpareNodes = 4096;
constexpr int kNodesLookedAt = 512;
constexpr std::size_t kMostBearing = 1024;
// Bricks nearer than this to the tool are not forgotten.
constexpr double kKept_mm = 2;

// What looking at a brick costs, in points made: passed over, and for so many densities.
constexpr int kPassedOverCost = 2;
constexpr int kLookedAtCost = 4;
constexpr int kDensitiesLookedAt = 60;

}  // namespace

BoneBricks::BoneBricks(const Volume& volume, double spacing_mm)
    : lattice_(volume, spacing_mm),
      nodes_(kNodes),
      fine_(kSlots, kFineChunks),
      coarse_(kSlots, kCoarseChunks),
      brick_of_slot_(kSlots),
      changes_(kSlots),
      without_bone_(kSlots) {
  choose_point_instructions();
  brick_radius_mm_ = 0.5 * lattice_.brick_nodes() * lattice_.step_mm().norm();
  const auto& dims = lattice_.brick_dims();
  while (1 << levels_ < *std::max_element(dims.begin(), dims.end())) ++levels_;
  for (std::size_t n = kSlots; n-- > 0;) free_slots_.push_back(static_cast<std::uint32_t>(n));
  for (std::size_t n = kNodes; n-- > kRoot + 1;) free_nodes_.push_back(static_cast<std::uint32_t>(n));
  nodes_[kRoot].places.fill(kUnseen);
  bearing_.reserve(kMostBearing);
}

Vec3 BoneBricks::middle_G(int level, const VoxelIndex& node) const {
  const double half = 0.5 * lattice_.brick_nodes() * static_cast<double>(1 << level);
  return lattice_.step_mm().cwiseProduct(half * Vec3(2 * node.i + 1, 2 * node.j + 1, 2 * node.k + 1) -
                                         Vec3::Ones());
}

// Whether it may hold surface; then a node has one in its place, as far as there are nodes, and a brick stays
// unseen until it is made.
bool BoneBricks::look(int level, const VoxelIndex& node, std::uint32_t& place) {
  const SurfaceLattice::Found found = lattice_.found_in(level, node);
  may_make_ -= kLookedAtCost;
  if (found != SurfaceLattice::Found::surface) {
    place = found == SurfaceLattice::Found::no_bone ? kNoBone : kBoneAlone;
    return false;
  }
  if (level == 0) return true;
  if (free_nodes_.empty()) return true;
  const std::uint32_t index = free_nodes_.back();
  free_nodes_.pop_back();
  nodes_[index].places.fill(kUnseen);
  nodes_[index].place = &place;
  place = index;
  return true;
}

// The brick's place or, where there is none, that of the least node it lies in.
BoneBricks::Found BoneBricks::find(const VoxelIndex& brick) {
  int level = levels_ - 1;
  const auto below = [&](std::uint32_t node) {
    const int n = (brick.i >> level & 1) + 2 * (brick.j >> level & 1) + 4 * (brick.k >> level & 1);
    return &nodes_[node].places[static_cast<std::size_t>(n)];
  };
  std::uint32_t* place = below(kRoot);
  while (level > 0 && is_index(*place)) {
    --level;
    place = below(*place);
  }
  return {level, place};
}

// Makes a brick, or makes it anew; returns what it cost.
int BoneBricks::make(const VoxelIndex& brick, std::uint32_t& place) {
  const std::uint32_t changes = lattice_.changes_of(brick);
  SurfaceLattice::RowBits without_bone{};
  if (is_index(place)) without_bone = without_bone_[place];
  lattice_.find_surface(brick, without_bone, found_);
  if (!is_index(place)) {
    place = kBoneAlone;
    if (found_.fine.count > 0) {
      place = free_slots_.back();
      free_slots_.pop_back();
      brick_of_slot_[place] = brick;
    }
  }
  if (is_index(place)) {
    changes_[place] = changes;
    without_bone_[place] = without_bone;
    const std::uint32_t stored = fine_.replace(place, found_.fine);
    SurfaceLattice::merge_flat_cells(found_);
    coarse_.replace(place, found_.coarse);
    if (stored == 0) {
      free_slots_.push_back(place);
      place = kBoneAlone;
    }
  }
  if (!found_.has_bone) place = kNoBone;
  return lattice_.densities_of_brick() / kDensitiesLookedAt + static_cast<int>(found_.fine.count);
}

// What is new comes first: where the surface has moved on into another brick it is found there before it is
// taken from where it was.
void BoneBricks::refresh(const VoxelBox& voxels, int others) noexcept {
  refreshed_ = true;
  for_each(lattice_.bricks_touched_by(voxels), [&](const VoxelIndex& brick) { others -= make_new(brick); });
  remake_bearing();
  sweep_.wait_for(voxels);
  int spent = 0;
  do {
    if (!sweep_.is_walking() && !start_sweep()) break;
    spent += remake(sweep_.brick());
    sweep_.advance();
  } while (spent < others);
}

bool BoneBricks::start_sweep() {
  const VoxelBox bricks = lattice_.bricks_touched_by(sweep_.take_waiting());
  if (bricks.empty()) return false;
  sweep_.start(bricks);
  return true;
}

// Where there was bone alone; what it cost.
int BoneBricks::make_new(const VoxelIndex& brick) {
  const auto [level, place] = find(brick);
  if (*place != kBoneAlone || lattice_.found_in(0, brick) != SurfaceLattice::Found::surface) return 0;
  if (level == 0 && has_room()) return make(brick, *place);
  *place = kUnseen;
  return kPassedOverCost;
}

// Where its points are of other densities; what it cost.
int BoneBricks::remake(const VoxelIndex& brick) {
  std::uint32_t* place = find(brick).place;
  if (!is_index(*place) || changes_[*place] == lattice_.changes_of(brick)) return kPassedOverCost;
  return make(brick, *place);
}

// Neighbours, whose slots follow one another, have their turns in different ticks.
void BoneBricks::remake_bearing() {
  int cost = 0;
  for (const std::uint32_t slot : bearing_) {
    cost += lattice_.densities_of_brick() / kDensitiesLookedAt + static_cast<int>(fine_.brick(slot).count);
  }
  const std::uint32_t turns = static_cast<std::uint32_t>(1 + cost / kBearingPerTick);
  ++refreshes_;
  bearing_owed_ = 0;
  for (const std::uint32_t slot : bearing_) {
    if ((refreshes_ + slot) % turns != 0) {
      ++bearing_owed_;
    } else if (fine_.brick(slot).count != 0) {
      remake(brick_of_slot_[slot]);
    }
  }
}

// For one more brick, however many points it has.
bool BoneBricks::has_room() const {
  constexpr std::size_t kMostChunks = SurfaceLattice::kMaxPointsOfBrick / PointChunk::kSlots + 1;
  return !free_slots_.empty() && fine_.free_chunks() >= kMostChunks && coarse_.free_chunks() >= kMostChunks;
}

void BoneBricks::make_room(const MillingTool& tool, const Pose& X_WT) noexcept {
  const Pose X_TW = X_WT.inverse();
  for (std::size_t n = 0; n < brick_of_slot_.size() && is_short_of_room(); ++n) {
    const std::uint32_t slot = static_cast<std::uint32_t>(next_to_forget_);
    next_to_forget_ = (next_to_forget_ + 1) % brick_of_slot_.size();
    if (fine_.brick(slot).count != 0 && !is_near(tool, X_TW, brick_of_slot_[slot])) forget(slot);
  }
  for (int n = 0; n < kNodesLookedAt && free_nodes_.size() < kSpareNodes; ++n) {
    forget_node(nodes_[next_node_to_forget_]);
    next_node_to_forget_ = (next_node_to_forget_ + 1) % kNodes;
  }
}

bool BoneBricks::is_short_of_room() const {
  return free_slots_.size() < kSpareSlots || fine_.free_chunks() < kSpareChunks ||
         coarse_.free_chunks() < kSpareChunks;
}

bool BoneBricks::is_near(const MillingTool& tool, const Pose& X_TW, const VoxelIndex& b) const {
  const Vec3 middle_W = lattice_.origin_W() + lattice_.direction() * middle_G(0, b);
  return tool_distance(tool, X_TW * middle_W).distance_mm < radius_mm(0) + kKept_mm;
}

void BoneBricks::forget(std::uint32_t slot) {
  *find(brick_of_slot_[slot]).place = kUnseen;
  fine_.replace(slot, PointRows{});
  coarse_.replace(slot, PointRows{});
  free_slots_.push_back(slot);
}

// Where nothing below it was made; near the tool it is soon there again.
void BoneBricks::forget_node(Node& node) {
  if (node.place == nullptr || std::any_of(node.places.begin(), node.places.end(), is_index)) return;
  free_nodes_.push_back(*node.place);
  *node.place = kUnseen;
  node.place = nullptr;
}

}  // namespace osteomill
