#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "osteomill/surface/surface_bricks.h"
#include "osteomill/surface/surface_copy.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// The isosurface of a volume that is being milled, kept up on a thread of its own from a copy of the
/// densities (4 bytes a voxel). Three threads meet here and none waits for another's work: the haptic thread
/// hands over what changed, the surface's own thread meshes it anew, the drawing thread takes the result.
class LiveSurface {
 public:
  /// What a tick copies at most, 16 KiB; all that a burr of 3 mm changes has gone within 20 ticks.
  static constexpr std::size_t kBricksPerTick = 8;

  /// Copies the volume's densities and starts meshing all of it.
  explicit LiveSurface(const Volume& volume);
  ~LiveSurface();
  LiveSurface(const LiveSurface&) = delete;
  LiveSurface& operator=(const LiveSurface&) = delete;

  const SurfaceBricks& layout() const;

  /// To be called by the haptic thread at every tick, with the volume given at construction (or one that
  /// began as its copy) and what the tick changed of it, an empty change too: a part of what is to be copied
  /// may have been left to later ticks. Safe in the haptic tick: copies at most a few bricks of 2 KiB, and
  /// never waits, allocates or throws.
  void volume_changed(const Volume& volume, const VolumeChange& change) noexcept;

  /// What changed since the last call, each brick once, as it is now; in the order of the bricks. The first
  /// call that brings anything brings the whole surface. For one drawing thread; never waits for meshing.
  std::vector<ChangedBrick> take_changed_bricks();

  /// Has the whole surface meshed anew at another isovalue; of several in short order, at the last one. Any
  /// thread but the haptic one.
  void set_isovalue(double isovalue);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
