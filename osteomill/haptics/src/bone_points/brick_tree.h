#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// An octree over bricks. An entry represents one brick (level 0) or a cube of 2^level bricks a side, and
/// stores what is known about it. Entries are unknown until the caller sets their content, and nodes without
/// bricks below them may be evicted, so neither time nor memory grows with the number of bricks. Copies are
/// independent. Building allocates; all else is safe in the haptic tick.
class BrickTree {
 public:
  /// The index of an entry, valid until its node is evicted.
  using EntryIndex = std::uint32_t;
  /// Contents other than an index. An index refers to a brick's slot (level 0) or a node.
  static constexpr std::uint32_t kUnknown = 0xffffffffu;
  static constexpr std::uint32_t kNoBone = 0xfffffffeu;
  static constexpr std::uint32_t kAllBone = 0xfffffffdu;
  static bool is_index(std::uint32_t value) { return value < kAllBone; }

  BrickTree() = default;
  explicit BrickTree(const std::array<int, 3>& brick_dims);

  std::uint32_t content(EntryIndex entry) const { return contents_[entry]; }
  /// One bit for each of a node's eight children, in the order of `below`.
  using EightBits = std::uint8_t;
  static VoxelIndex below(const VoxelIndex& node, int n) {
    return {2 * node.i + n % 2, 2 * node.j + n / 2 % 2, 2 * node.k + n / 4};
  }
  /// Traverses the octree and calls `use(level, node, entry)` for each unknown entry and each brick with a
  /// slot, in a fixed order. Skips entries without surface, and children of `node` whose bit is not set in
  /// `overlap(level, node)`. Creates nothing; if `use` adds a node to the entry, the traversal descends into
  /// it.
  template <typename Overlap, typename Use>
  void visit(const Overlap& overlap, const Use& use) const {
    walk(levels_, {}, kRoot, overlap, use);
  }
  /// Returns the brick's entry and level 0, or the smallest enclosing entry that has no node, and its level.
  std::pair<EntryIndex, int> find(const VoxelIndex& brick) const;

  /// Sets an entry's content: kUnknown, kNoBone, kAllBone or, for a brick, its slot.
  void set_content(EntryIndex entry, std::uint32_t value) { contents_[entry] = value; }
  /// Gives an unknown entry above level 0 a node with eight unknown entries. Leaves it unknown if no node is
  /// free.
  void add_node(EntryIndex entry);
  /// If few nodes are free, scans the next few and evicts those without slots or nodes below them.
  void evict_nodes();

 private:
  static constexpr std::uint32_t kRoot = 0;
  // Entry recorded for the root and for free nodes.
  static constexpr EntryIndex kNoEntry = 0xffffffffu;

  template <typename Overlap, typename Use>
  void walk(int level, const VoxelIndex& node, std::uint32_t index, const Overlap& overlap,
            const Use& use) const {
    const EightBits met = overlap(level, node);
    --level;
    for (int n = 0; n < 8; ++n) {
      const EntryIndex entry = 8 * index + static_cast<EntryIndex>(n);
      if ((met >> n & 1) == 0 || contents_[entry] == kNoBone || contents_[entry] == kAllBone) continue;
      if (level == 0 || contents_[entry] == kUnknown) use(level, below(node, n), entry);
      if (level > 0 && is_index(contents_[entry]))
        walk(level, below(node, n), contents_[entry], overlap, use);
    }
  }

  // Levels above the bricks.
  int levels_ = 1;
  // Eight entries per node.
  std::vector<std::uint32_t> contents_;
  std::vector<EntryIndex> entry_of_node_;
  std::vector<std::uint32_t> free_;
  std::size_t free_count_ = 0;
  std::size_t next_to_evict_ = 0;
};

}  // namespace osteomill
