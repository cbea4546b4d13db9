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

/// Follows a bone that is being milled, for every thread but the haptic one. It keeps the one copy of the
/// bone's densities (which shares with the bone the memory of what was not milled); from the copy its own
/// thread keeps the surface up, cuts are drawn and files saved, and in the copy cuts are taken back. The
/// haptic thread hands over what changed and never waits. All others wait for each other no longer than a few
/// changed bricks take to be put in place or meshed (the whole bone after another isovalue).
class BoneFollower {
 public:
  /// The most bricks that a tick copies, 16 KiB. All that a burr of 3 mm changes is sent within 20 ticks.
  static constexpr std::size_t kBricksPerTick = 8;
  /// The most memory for cuts that can be taken back.
  static constexpr std::size_t kUndoBytes = std::size_t{256} << 20;

  /// Copies the bone and meshes all of it. From then on makes the memory that milling takes ready ahead of
  /// the burr (Volume::prefault_around).
  explicit BoneFollower(std::shared_ptr<Volume> bone, std::size_t undo_bytes = kUndoBytes);
  ~BoneFollower();

  /// Puts what was milled of this bone at another time into bone and copy, as one cut, of which `piece_drops`
  /// was removed as pieces. Before the first tick.
  void load_milled(const std::vector<DensityBlock>& milled, const std::vector<double>& piece_drops = {});

  /// Hands over what a tick changed of the bone. The haptic thread calls it at every tick, with an empty
  /// change too: a part of what is to be copied may have been left to later ticks. Safe in the haptic tick:
  /// copies at most a few bricks of 2 KiB, and never waits, allocates or throws.
  void bone_changed(const Volume& bone, const VolumeChange& change) noexcept;

  /// Returns the bricks of the surface.
  const SurfaceBricks& layout() const;
  /// Returns what changed of the surface since the last call. The first call that brings anything brings the
  /// whole surface. For one drawing thread; never waits for meshing.
  ChangedBricks take_changed_bricks();
  /// Lets the whole surface be meshed again at another isovalue; of several in short order, at the last one.
  /// The bone's own isovalue stays. For any thread except the haptic one, as all functions below.
  void show_isovalue(double isovalue);

  /// Lets `use` read the bone as last handed over, some ticks behind. The copy does not change meanwhile.
  void read(const std::function<void(const Volume&)>& use) const;
  /// Returns a number that grows with every change of what is read.
  std::uint64_t version() const;

  /// Begins another cut, to which all that is milled from now on belongs; `removed_mm3` is what was removed
  /// before it.
  void begin_cut(double removed_mm3);
  /// Returns how many cuts can be taken back; the removal of pieces is one.
  std::size_t cuts() const;
  /// Returns how many cuts that were taken back can be made again: none once something else was cut.
  std::size_t undone_cuts() const;
  /// Returns whether anything was milled, or a piece removed, since the beginning.
  bool is_touched() const;
  /// Returns every brick that was ever changed, as it is now.
  std::vector<DensityBlock> touched_bricks() const;
  /// Returns by how much densities have fallen since the beginning times the voxels' volume, mm^3, summed
  /// over each label's voxels, by its place; removed pieces do not count. Empty for a bone without labels.
  std::vector<double> drops_by_label() const;
  /// Returns the same of the pieces that are removed; empty if there are none.
  std::vector<double> piece_drops() const;

  /// Puts what has arrived into the copy. Returns true if nothing is left to come, so that the copy is the
  /// bone, provided that the bone is frozen (HapticThread::freeze_bone).
  bool catch_up();

  /// The copy, made ready to become the bone.
  struct NextBone {
    std::shared_ptr<Volume> bone;
    /// The bone that is then removed of it, in mm^3 of reference density.
    double removed_mm3;
    /// Given if another isovalue changes them.
    std::optional<BoneDensities> densities;
  };
  /// Returns the copy with the last cut taken back; `removed_mm3` is removed of the bone now. Call this, and
  /// each of the next four, while the bone is frozen and the copy is caught up; from then until `swap` or
  /// `discard_next` no thread writes into either. The surface shows the change at once; the cut is gone with
  /// `swap`.
  NextBone without_last_cut(double removed_mm3);
  /// Returns the copy with the cut made again that was taken back last.
  NextBone with_undone_cut(double removed_mm3);
  /// Returns the copy without some of its pieces, as another cut, which does not count as milled. Throws as
  /// `bricks_without` does, with the bricks that `undo_bytes` has room for.
  NextBone without_pieces(const PieceRemoval& removal, double removed_mm3);
  /// Returns the copy as the bone was at the beginning.
  NextBone without_all_cuts();
  /// Returns the copy with another isovalue. Voxels that milling had emptied (cut down to `surroundings`)
  /// stay empty. Throws std::invalid_argument if the isovalue is not finite.
  NextBone with_isovalue(double isovalue, double surroundings, double removed_mm3);
  /// Makes the copy the bone. The bone before it, which no tick uses any more, becomes the copy, so that
  /// there are never more than the two.
  void swap();
  /// Makes the copy again what the bone is.
  void discard_next();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace osteomill
