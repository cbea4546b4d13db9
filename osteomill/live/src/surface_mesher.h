#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>

#include "osteomill/visual/surface_bricks.h"
#include "osteomill/visual/surface_upkeep.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Meshes the surface of a bone for the drawing thread. Callers must not run `mark` and `mesh` concurrently;
/// `take` and `show_isovalue` may be called from any thread.
class SurfaceMesher {
 public:
  SurfaceMesher(const SurfaceBricks& layout, double isovalue);

  /// Marks voxels whose densities changed.
  void mark(const VoxelBox& voxels) { upkeep_.mark(voxels); }
  /// Meshes the marked bricks, or the whole bone if another isovalue was requested.
  void mesh(const Volume& bone);
  /// Waits until the next check for changes is due, another isovalue was requested, or stop was requested.
  void wait(const std::stop_token& stop);

  /// Requests remeshing of the whole surface at this isovalue, which may differ from the bone's.
  void show_isovalue(double isovalue);
  /// Returns the bricks meshed since the last call.
  ChangedBricks take();

 private:
  SurfaceUpkeep upkeep_;
  double shown_isovalue_;
  std::mutex mutex_;
  // Bricks that the drawing thread has not yet taken.
  ChangedBricks published_;
  std::optional<double> new_isovalue_;
  std::condition_variable_any woken_;
};

}  // namespace osteomill
