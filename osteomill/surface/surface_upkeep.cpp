#include "osteomill/surface/surface_upkeep.h"

#include <numeric>

#include "osteomill/numbers/work_progress.h"
#include "osteomill/surface/brick_mesher.h"

namespace osteomill {

SurfaceUpkeep::SurfaceUpkeep(const SurfaceBricks& layout) : layout_(layout), has_mesh_(layout.count(), 0) {
  mark_all();
}

void SurfaceUpkeep::mark_all() {
  marked_.assign(layout_.count(), 1);
  to_mesh_.resize(layout_.count());
  std::iota(to_mesh_.begin(), to_mesh_.end(), std::size_t{0});
  calls_left_.assign(layout_.count(), 0);
  changing_.clear();
}

void SurfaceUpkeep::mark(const VoxelBox& voxels) {
  for_each(layout_.touched_by(voxels), [&](const VoxelIndex& brick) {
    const std::size_t number = layout_.index(brick.i, brick.j, brick.k);
    if (!marked_[number]) to_mesh_.push_back(number);
    marked_[number] = 1;
    if (calls_left_[number] == 0) changing_.push_back(number);
    calls_left_[number] = kCallsAtRest;
  });
}

ChangedBricks SurfaceUpkeep::remesh(const DensityView& view) {
  std::size_t at_rest = 0;
  std::erase_if(changing_, [&](std::size_t brick) {
    if (calls_left_[brick] > 1) {
      --calls_left_[brick];
      return false;
    }
    if (at_rest++ >= kMostAtRest) return false;
    calls_left_[brick] = 0;
    to_mesh_.push_back(brick);
    return true;
  });
  ChangedBricks changed;
  BrickMesher mesher(view);
  for (std::size_t n = 0; n < to_mesh_.size(); ++n) {
    const std::size_t brick = to_mesh_[n];
    if (n % 64 == 0) WorkProgress::done(n, to_mesh_.size());
    marked_[brick] = 0;
    const BrickMesh& mesh = mesher.mesh(brick);
    const bool had_mesh = has_mesh_[brick] != 0;
    has_mesh_[brick] = !mesh.empty();
    if (!had_mesh && mesh.empty()) continue;
    changed[brick] = calls_left_[brick] > 0 ? full_detail(mesh)
                                            : levels_of(mesh, view.grid.geometry(), layout_.cells(brick));
  }
  to_mesh_.clear();
  return changed;
}

}  // namespace osteomill
