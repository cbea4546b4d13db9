#include "osteomill/visual/surface_upkeep.h"

#include "osteomill/base/work_progress.h"

#include "surface/brick_mesher.h"

namespace osteomill {

SurfaceUpkeep::SurfaceUpkeep(const SurfaceBricks& layout) : layout_(layout), has_mesh_(layout.count(), 0) {
  mark_all();
}

void SurfaceUpkeep::mark_all() {
  for (std::size_t brick = 0; brick < layout_.count(); ++brick) to_mesh_.insert(to_mesh_.end(), brick);
  changing_.clear();
}

void SurfaceUpkeep::mark(const VoxelBox& voxels) {
  for_each(layout_.bricks_depending_on(voxels), [&](const VoxelIndex& brick) {
    const std::size_t number = layout_.index(brick.i, brick.j, brick.k);
    to_mesh_.insert(number);
    changing_[number] = calls_;
  });
}

ChangedBricks SurfaceUpkeep::remesh(const DensityView& view) {
  std::size_t at_rest = 0;
  ++calls_;
  std::erase_if(changing_, [&](const auto& brick_and_call) {
    const auto& [brick, call] = brick_and_call;
    if (calls_ - call < kCallsUntilRest || at_rest++ >= kMaxRefinedPerCall) return false;
    to_mesh_.insert(brick);
    return true;
  });
  ChangedBricks changed;
  BrickMesher mesher(view);
  std::size_t done = 0;
  for (const std::size_t brick : to_mesh_) {
    if (done++ % 64 == 0) WorkProgress::done(done, to_mesh_.size());
    const BrickMesh& mesh = mesher.mesh(brick);
    const bool had_mesh = has_mesh_[brick] != 0;
    has_mesh_[brick] = !mesh.empty();
    if (!had_mesh && mesh.empty()) continue;
    changed[brick] = changing_.contains(brick)
                         ? full_detail(mesh)
                         : build_levels(mesh, view.grid.geometry(), layout_.cells(brick));
  }
  to_mesh_.clear();
  return changed;
}

}  // namespace osteomill
