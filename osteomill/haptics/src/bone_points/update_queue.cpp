#include "bone_points/update_queue.h"

#include "osteomill/base/row_major.h"

namespace osteomill {

void UpdateQueue::add(const VoxelBox& bricks) {
  if (bricks.empty()) return;
  added_ = true;
  waiting_.include(bricks.first);
  waiting_.include(bricks.last);
}

std::optional<VoxelIndex> UpdateQueue::next() {
  if (walked_.empty()) {
    walked_ = std::exchange(waiting_, {});
    if (walked_.empty()) return std::nullopt;
    next_ = walked_.first;
  }
  const VoxelIndex taken = next_;
  if (++next_.i > walked_.last.i) {
    next_.i = walked_.first.i;
    if (++next_.j > walked_.last.j) {
      next_.j = walked_.first.j;
      if (++next_.k > walked_.last.k) walked_ = {};
    }
  }
  return taken;
}

std::size_t UpdateQueue::size() const {
  std::size_t waiting = supporting_pending_;
  if (!waiting_.empty()) waiting += cell_count(waiting_.dims());
  if (!walked_.empty()) {
    const VoxelIndex& first = walked_.first;
    waiting += cell_count(walked_.dims()) -
               row_major(walked_.dims(), next_.i - first.i, next_.j - first.j, next_.k - first.k);
  }
  return waiting;
}

}  // namespace osteomill
