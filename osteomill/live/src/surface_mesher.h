#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>

#include "osteomill/visual/surface_bricks.h"
#include "osteomill/visual/surface_upkeep.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Keeps the surface of a bone up for the thread that draws. `mark` and `mesh` are for threads that keep each
/// other out; `take` and `show_isovalue` are for any.
class SurfaceMesher {
 public:
  SurfaceMesher(const SurfaceBricks& layout, double isovalue);

  /// Notes voxels whose densities changed.
  void mark(const VoxelBox& voxels) { upkeep_.mark(voxels); }
  /// Meshes what was marked, or all of the bone if another isovalue is to be shown.
  void mesh(const Volume& bone);
  /// Waits until it is time to look for changes again, another isovalue is to be shown, or stop is requested.
  void wait(const std::stop_token& stop);

  /// Lets the whole surface be meshed again at this isovalue, which need not be the bone's.
  void show_isovalue(double isovalue);
  /// Returns what was meshed since the last call.
  ChangedBricks take();

 private:
  SurfaceUpkeep upkeep_;
  double shown_isovalue_;
  std::mutex mutex_;
  // The bricks that the drawing thread has not taken yet.
  ChangedBricks published_;
  std::optional<double> new_isovalue_;
  std::condition_variable_any woken_;
};

}  // namespace osteomill
