#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// An octree over bricks that keeps what is known of each place: a brick (level 0), or 2^level bricks a side.
/// Places are unseen until somebody puts there what was found, and nodes without bricks below them may be
/// forgotten, so that neither time nor memory grows with the number of bricks. A value: copies share nothing.
/// Building allocates; all else is safe in the haptic tick.
class BrickTree {
 public:
  /// Names a place; good until its node is forgotten.
  using Place = std::uint32_t;
  /// The marks of a place that holds no index: neither that of a brick's slot nor, for a larger place, that
  /// of its node.
  static constexpr std::uint32_t kUnseen = 0xffffffffu;
  static constexpr std::uint32_t kNoBone = 0xfffffffeu;
  static constexpr std::uint32_t kBoneAlone = 0xfffffffdu;
  static bool is_index(std::uint32_t held) { return held < kBoneAlone; }

  BrickTree() = default;
  explicit BrickTree(const std::array<int, 3>& brick_dims);

  std::uint32_t held(Place place) const { return held_[place]; }
  /// The eight nodes below one, a bit each in the order of `below`.
  using EightBits = std::uint8_t;
  static VoxelIndex below(const VoxelIndex& node, int n) {
    return {2 * node.i + n % 2, 2 * node.j + n / 2 % 2, 2 * node.k + n / 4};
  }
  /// Goes down the octree, leaving out every place below `node` whose bit is not set in
  /// `meets(level, node)` and all that hold no surface, and calls `use(level, node, place)` for each unseen
  /// place and each brick with a slot, in a fixed order. Creates nothing; if `use` opens a place, the walk
  /// goes on below it.
  template <typename Meets, typename Use>
  void visit(const Meets& meets, const Use& use) const {
    walk(levels_, {}, kRoot, meets, use);
  }
  /// Returns the brick's place and level 0, or the least place with the brick in it that has no node.
  std::pair<Place, int> find(const VoxelIndex& brick) const;

  /// Notes what was found at a place: kUnseen, kNoBone, kBoneAlone or, of a brick, a slot.
  void put(Place place, std::uint32_t held) { held_[place] = held; }
  /// Gives an unseen place above the bricks a node, whose eight places are unseen. It stays unseen if no node
  /// is free.
  void open(Place place);
  /// Forgets nodes without slots or nodes below them, if few are free: those of the next few in turn.
  void forget_nodes();

 private:
  static constexpr std::uint32_t kRoot = 0;
  // The place of the root and of free nodes.
  static constexpr Place kNoPlace = 0xffffffffu;

  template <typename Meets, typename Use>
  void walk(int level, const VoxelIndex& node, std::uint32_t index, const Meets& meets,
            const Use& use) const {
    const EightBits met = meets(level, node);
    --level;
    for (int n = 0; n < 8; ++n) {
      const Place place = 8 * index + static_cast<Place>(n);
      if ((met >> n & 1) == 0 || held_[place] == kNoBone || held_[place] == kBoneAlone) continue;
      if (level == 0 || held_[place] == kUnseen) use(level, below(node, n), place);
      if (level > 0 && is_index(held_[place])) walk(level, below(node, n), held_[place], meets, use);
    }
  }

  // Bricks not counted.
  int levels_ = 1;
  // Eight for each node.
  std::vector<std::uint32_t> held_;
  std::vector<Place> place_of_node_;
  std::vector<std::uint32_t> free_;
  std::size_t free_count_ = 0;
  std::size_t next_to_forget_ = 0;
};

}  // namespace osteomill
