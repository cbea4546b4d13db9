#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "osteomill/visual/surface_bricks.h"
#include "osteomill/visual/surface_upkeep.h"
#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/bone_pieces.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Mirrors a bone that is being milled, for every thread but the haptic one. Holds the only copy of the
/// bone's densities, which shares the memory of unmilled bone with the original. The follower's own thread
/// meshes the copy; cuts are drawn, files saved and cuts undone from it. The haptic thread hands over changes
/// and never waits. Other threads wait for each other at most as long as copying or meshing a few changed
/// bricks takes (or meshing the whole bone after a change of isovalue).
class BoneFollower {
 public:
  /// Maximum bricks copied per tick, 16 KiB. The changes of a 3 mm burr are sent within 20 ticks.
  static constexpr std::size_t kBricksPerTick = 8;
  /// Memory limit for cuts that can be undone.
  static constexpr std::size_t kUndoBytes = std::size_t{256} << 20;

  /// Copies the bone and meshes all of it. From then on pre-faults memory ahead of the burr
  /// (Volume::prefault_around).
  explicit BoneFollower(std::shared_ptr<Volume> bone, std::size_t undo_bytes = kUndoBytes);
  ~BoneFollower();

  /// Applies earlier milling of this bone to bone and copy, as one cut. `piece_drops` is the part of it that
  /// was removed as pieces. Call before the first tick.
  void load_milled(const std::vector<DensityBlock>& milled, const std::vector<double>& piece_drops = {});

  /// Hands over the changes of a tick. The haptic thread calls this in every tick, also with an empty change,
  /// because bricks may still wait from earlier ticks. Safe in the haptic tick: copies at most a few bricks
  /// of 2 KiB and never waits, allocates or throws.
  void bone_changed(const Volume& bone, const VolumeChange& change) noexcept;

  /// Returns the brick layout of the surface.
  const SurfaceBricks& layout() const;
  /// Returns the surface changes since the last call; the first non-empty result is the whole surface. For
  /// one drawing thread; never waits for meshing.
  ChangedBricks take_changed_bricks();
  /// Requests remeshing of the whole surface at another isovalue; the last of several requests wins. Does not
  /// change the bone's own isovalue. This and all functions below: any thread except the haptic one.
  void show_isovalue(double isovalue);

  /// Calls `use` with the copy, which is some ticks behind the bone and does not change during the call.
  void read(const std::function<void(const Volume&)>& use) const;
  /// Returns the version of the copy, which increases with every change.
  std::uint64_t version() const;

  /// Begins another cut; all milling from now on belongs to it. `removed_mm3` is the volume removed before
  /// it.
  void begin_cut(double removed_mm3);
  /// Returns the number of cuts that can be undone, removals of pieces included.
  std::size_t cuts() const;
  /// Returns the number of undone cuts that can be redone: 0 after any new cut.
  std::size_t undone_cuts() const;
  /// Returns whether any cut or removal of a piece is not undone.
  bool is_touched() const;
  /// Returns every brick that was ever changed, with its present densities.
  std::vector<DensityBlock> touched_bricks() const;
  /// Returns the decrease in density since the beginning times the voxel volume, mm^3, summed per label and
  /// indexed by label place. Excludes removed pieces. Empty for a bone without labels.
  std::vector<double> drops_by_label() const;
  /// Returns the corresponding sums for removed pieces; empty if there are none.
  std::vector<double> piece_drops() const;

  /// Applies queued changes to the copy. Returns true if none are left, so that the copy equals the bone,
  /// provided that the bone is frozen (HapticThread::freeze_bone).
  bool catch_up();

  /// The copy, prepared to replace the bone.
  struct NextBone {
    std::shared_ptr<Volume> bone;
    /// Bone removed in that state, mm^3 of reference density.
    double removed_mm3;
    /// Set only if the isovalue changes and with it the densities.
    std::optional<BoneDensities> densities;
  };
  /// Returns the copy with the last cut undone; `removed_mm3` is the volume removed so far. Call this and the
  /// next four functions only while the bone is frozen and the copy is caught up; from then until `swap` or
  /// `discard_next` no thread may write to either. The surface shows the change at once; the cut leaves the
  /// undo list with `swap`.
  NextBone without_last_cut(double removed_mm3);
  /// Returns the copy with the last undone cut redone.
  NextBone with_undone_cut(double removed_mm3);
  /// Returns the copy with pieces removed, as a cut of its own that does not count as milled. Throws as
  /// `bricks_without` does; `undo_bytes` limits the number of bricks.
  NextBone without_pieces(const PieceRemoval& removal, double removed_mm3);
  /// Returns the copy with the bone's original densities.
  NextBone without_all_cuts();
  /// Returns the copy with another isovalue. Voxels that milling had emptied (down to `surroundings`) stay
  /// empty. Throws std::invalid_argument if the isovalue is not finite.
  NextBone with_isovalue(double isovalue, double surroundings, double removed_mm3);
  /// Makes the copy the bone. The previous bone, which no tick may use any more, becomes the copy, so that no
  /// third one is needed.
  void swap();
  /// Restores the copy to the state of the bone.
  void discard_next();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace osteomill
