#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "osteomill/numbers/row_major.h"

namespace osteomill {

/// An implicit octree over a grid of bricks: level 0 holds a count for every brick, each further level the
/// sums of 2 x 2 x 2 counts of the level below, the last level a single count. A node without points is not
/// entered, and because every node has its place, points come and go without an allocation.
class CountPyramid {
 public:
  CountPyramid() = default;
  /// All counts zero. Every dimension at least 1.
  explicit CountPyramid(const std::array<int, 3>& dims) {
    std::array<int, 3> level_dims = dims;
    while (true) {
      Level level{level_dims, {}};
      level.counts.assign(cell_count(level_dims), 0);
      levels_.push_back(std::move(level));
      if (level_dims == std::array<int, 3>{1, 1, 1}) return;
      for (int& dim : level_dims) dim = (dim + 1) / 2;
    }
  }

  int level_count() const { return static_cast<int>(levels_.size()); }
  const std::array<int, 3>& dims(int level) const { return levels_[static_cast<std::size_t>(level)].dims; }
  std::uint32_t count(int level, int i, int j, int k) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    return l.counts[row_major(l.dims, i, j, k)];
  }
  std::uint32_t total() const { return levels_.empty() ? 0 : levels_.back().counts.front(); }
  /// Adds `difference` to a brick's count and to the sums above it. Safe in the haptic tick.
  void add(int i, int j, int k, std::int32_t difference) {
    for (Level& level : levels_) {
      // Unsigned arithmetic wraps: adding a negative difference subtracts.
      level.counts[row_major(level.dims, i, j, k)] += static_cast<std::uint32_t>(difference);
      i /= 2;
      j /= 2;
      k /= 2;
    }
  }

  /// Calls `leaf(i, j, k)` for every brick with points that no `rejected(level, i, j, k)` cut off, a node's
  /// answer standing for all below it. The order is fixed. Safe in the haptic tick.
  template <typename Rejected, typename Leaf>
  void visit(const Rejected& rejected, Leaf&& leaf) const {
    if (!levels_.empty()) visit_node(level_count() - 1, 0, 0, 0, rejected, leaf);
  }

 private:
  struct Level {
    std::array<int, 3> dims;
    std::vector<std::uint32_t> counts;
  };

  template <typename Rejected, typename Leaf>
  void visit_node(int level, int i, int j, int k, const Rejected& rejected, Leaf&& leaf) const {
    if (count(level, i, j, k) == 0 || rejected(level, i, j, k)) return;
    if (level == 0) {
      leaf(i, j, k);
      return;
    }
    const auto& below = dims(level - 1);
    for (int c = 2 * k; c < 2 * k + 2 && c < below[2]; ++c) {
      for (int b = 2 * j; b < 2 * j + 2 && b < below[1]; ++b) {
        for (int a = 2 * i; a < 2 * i + 2 && a < below[0]; ++a) {
          visit_node(level - 1, a, b, c, rejected, leaf);
        }
      }
    }
  }

  std::vector<Level> levels_;
};

}  // namespace osteomill
