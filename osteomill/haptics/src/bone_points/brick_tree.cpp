#include "bone_points/brick_tree.h"

#include <algorithm>

namespace osteomill {

namespace {

constexpr std::size_t kNodes = 32768;
constexpr std::size_t kSpareNodes = 4096;
// How many are looked at a tick for one to forget.
constexpr int kNodesLookedAt = 512;

}  // namespace

BrickTree::BrickTree(const std::array<int, 3>& brick_dims)
    : held_(8 * kNodes, kUnseen), place_of_node_(kNodes, kNoPlace), free_(kNodes) {
  while (1 << levels_ < *std::max_element(brick_dims.begin(), brick_dims.end())) ++levels_;
  for (std::size_t n = kNodes; n-- > kRoot + 1;) free_[free_count_++] = static_cast<std::uint32_t>(n);
}

std::pair<BrickTree::Place, int> BrickTree::find(const VoxelIndex& brick) const {
  int level = levels_ - 1;
  const auto below = [&](std::uint32_t node) {
    const int n = (brick.i >> level & 1) + 2 * (brick.j >> level & 1) + 4 * (brick.k >> level & 1);
    return 8 * node + static_cast<Place>(n);
  };
  Place place = below(kRoot);
  while (level > 0 && is_index(held_[place])) {
    --level;
    place = below(held_[place]);
  }
  return {place, level};
}

void BrickTree::open(Place place) {
  if (free_count_ == 0) return;
  const std::uint32_t node = free_[--free_count_];
  std::fill_n(&held_[8 * node], 8, kUnseen);
  place_of_node_[node] = place;
  held_[place] = node;
}

void BrickTree::forget_nodes() {
  for (int n = 0; n < kNodesLookedAt && free_count_ < kSpareNodes; ++n) {
    const std::uint32_t* held = &held_[8 * next_to_forget_];
    Place& place = place_of_node_[next_to_forget_];
    if (place != kNoPlace && std::none_of(held, held + 8, is_index)) {
      held_[place] = kUnseen;
      place = kNoPlace;
      free_[free_count_++] = static_cast<std::uint32_t>(next_to_forget_);
    }
    next_to_forget_ = (next_to_forget_ + 1) % kNodes;
  }
}

}  // namespace osteomill
