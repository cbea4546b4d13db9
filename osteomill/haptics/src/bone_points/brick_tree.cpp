#include "bone_points/brick_tree.h"

#include <algorithm>

namespace osteomill {

namespace {

constexpr std::size_t kNodes = 32768;
constexpr std::size_t kSpareNodes = 4096;
// Nodes that a tick scans for eviction.
constexpr int kScannedNodes = 512;

}  // namespace

BrickTree::BrickTree(const std::array<int, 3>& brick_dims)
    : contents_(8 * kNodes, kUnknown), entry_of_node_(kNodes, kNoEntry), free_(kNodes) {
  while (1 << levels_ < *std::max_element(brick_dims.begin(), brick_dims.end())) ++levels_;
  for (std::size_t n = kNodes; n-- > kRoot + 1;) free_[free_count_++] = static_cast<std::uint32_t>(n);
}

std::pair<BrickTree::EntryIndex, int> BrickTree::find(const VoxelIndex& brick) const {
  int level = levels_ - 1;
  const auto below = [&](std::uint32_t node) {
    const int n = (brick.i >> level & 1) + 2 * (brick.j >> level & 1) + 4 * (brick.k >> level & 1);
    return 8 * node + static_cast<EntryIndex>(n);
  };
  EntryIndex entry = below(kRoot);
  while (level > 0 && is_index(contents_[entry])) {
    --level;
    entry = below(contents_[entry]);
  }
  return {entry, level};
}

void BrickTree::add_node(EntryIndex entry) {
  if (free_count_ == 0) return;
  const std::uint32_t node = free_[--free_count_];
  std::fill_n(&contents_[8 * node], 8, kUnknown);
  entry_of_node_[node] = entry;
  contents_[entry] = node;
}

void BrickTree::evict_nodes() {
  for (int n = 0; n < kScannedNodes && free_count_ < kSpareNodes; ++n) {
    const std::uint32_t* children = &contents_[8 * next_to_evict_];
    EntryIndex& entry = entry_of_node_[next_to_evict_];
    if (entry != kNoEntry && std::none_of(children, children + 8, is_index)) {
      contents_[entry] = kUnknown;
      entry = kNoEntry;
      free_[free_count_++] = static_cast<std::uint32_t>(next_to_evict_);
    }
    next_to_evict_ = (next_to_evict_ + 1) % kNodes;
  }
}

}  // namespace osteomill
