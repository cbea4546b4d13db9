#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "osteomill/haptics/barrier_shell/surface_lattice.h"
#include "osteomill/haptics/bone_points/brick_sweep.h"
#include "osteomill/haptics/bone_points/count_pyramid.h"

namespace osteomill::barrier_shell {

/// The bone's surface as points in bricks, made when the tool comes near and forgotten when room runs out, so
/// that neither time nor memory grows with the scan. Milling takes densities away only, so a brick that has
/// not been brought up to date shows more bone than there is. Building allocates; all else is safe in the
/// haptic tick.
class BoneBricks {
 public:
  BoneBricks() = default;
  /// `volume` outlives it. Points at most `spacing_mm` apart, and others twice as far where the bone is flat.
  BoneBricks(const Volume& volume, double spacing_mm);

  const SurfaceLattice& lattice() const { return lattice_; }
  const BrickPoints& fine() const { return fine_; }
  const BrickPoints& coarse() const { return coarse_; }
  /// Counts points of the bricks that were made, and one of each other that may have some.
  const CountPyramid& octree() const { return octree_; }
  /// A box that holds all points of a node of the octree, in the grid's frame: its middle, and the radius of
  /// the sphere about it.
  Vec3 node_middle_G(int level, int i, int j, int k) const;
  double node_radius_mm(int level) const { return node_radii_mm_[static_cast<std::size_t>(level)]; }

  static constexpr std::uint32_t kNoPoints = 0xffffffffu;
  /// The slot of the brick in `fine` and `coarse`, which is made if it was not; `kNoPoints` where it has
  /// none.
  std::uint32_t slot_of(const VoxelIndex& brick);
  bool is_made(const VoxelIndex& brick) const { return slots_[index_of(brick)] != kUnmade; }

  /// Says that densities fell in `voxels`, and brings about `budget` edges' worth of points up to date.
  void refresh(const VoxelBox& voxels, int budget);
  bool is_up_to_date() const { return sweep_.is_idle(); }
  /// Makes room if little is left, by forgetting bricks of which `is_needed(brick)` says that they are not.
  template <typename IsNeeded>
  void make_room(const IsNeeded& is_needed);
  /// Points that found no room: none as long as `make_room` was called.
  std::uint64_t dropped() const { return fine_.dropped() + coarse_.dropped(); }

 private:
  static constexpr std::uint32_t kUnmade = 0xfffffffeu;

  std::size_t index_of(const VoxelIndex& b) const {
    const auto& dims = octree_.dims(0);
    return static_cast<std::size_t>(b.i) +
           static_cast<std::size_t>(dims[0]) *
               (static_cast<std::size_t>(b.j) +
                static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(b.k));
  }
  int make(const VoxelIndex& brick);
  int visit(const VoxelIndex& brick);
  bool start_sweep();
  bool is_short_of_room() const;
  void forget(std::uint32_t slot);

  SurfaceLattice lattice_;
  CountPyramid octree_;
  std::vector<double> node_radii_mm_;
  std::vector<std::uint32_t> slots_;
  BrickPoints fine_;
  BrickPoints coarse_;
  std::vector<std::uint32_t> free_slots_;
  // Which brick a slot is of, and where forgetting goes on.
  std::vector<VoxelIndex> brick_of_slot_;
  // Of the densities that its points are of.
  std::vector<std::uint64_t> fingerprints_;
  std::size_t next_to_forget_ = 0;
  BrickSweep sweep_;
  std::unique_ptr<SurfaceLattice::BrickSurface> found_;
};

template <typename IsNeeded>
void BoneBricks::make_room(const IsNeeded& is_needed) {
  for (std::size_t n = 0; n < brick_of_slot_.size() && is_short_of_room(); ++n) {
    const std::uint32_t slot = static_cast<std::uint32_t>(next_to_forget_);
    next_to_forget_ = (next_to_forget_ + 1) % brick_of_slot_.size();
    if (fine_.brick(slot).count != 0 && !is_needed(brick_of_slot_[slot])) forget(slot);
  }
}

}  // namespace osteomill::barrier_shell
