#include "bone_points/update_queue.h"

#include "osteomill/base/row_major.h"

namespace osteomill {

void UpdateQueue::add(const VoxelBox& bricks) {
  if (bricks.empty()) return;
  added_ = true;
  pending_box_.include(bricks.first);
  pending_box_.include(bricks.last);
}

std::optional<VoxelIndex> UpdateQueue::next() {
  if (active_box_.empty()) {
    active_box_ = std::exchange(pending_box_, {});
    if (active_box_.empty()) return std::nullopt;
    next_ = active_box_.first;
  }
  const VoxelIndex taken = next_;
  if (++next_.i > active_box_.last.i) {
    next_.i = active_box_.first.i;
    if (++next_.j > active_box_.last.j) {
      next_.j = active_box_.first.j;
      if (++next_.k > active_box_.last.k) active_box_ = {};
    }
  }
  return taken;
}

std::size_t UpdateQueue::size() const {
  std::size_t waiting = supporting_pending_;
  if (!pending_box_.empty()) waiting += cell_count(pending_box_.dims());
  if (!active_box_.empty()) {
    const VoxelIndex& first = active_box_.first;
    waiting += cell_count(active_box_.dims()) -
               row_major(active_box_.dims(), next_.i - first.i, next_.j - first.j, next_.k - first.k);
  }
  return waiting;
}

}  // namespace osteomill
