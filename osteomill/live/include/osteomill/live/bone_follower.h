#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "osteomill/base/spsc_queue.h"
#include "osteomill/live/cut_history.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/visual/surface_upkeep.h"
#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Copies of changed densities on their way from the thread that mills to one that keeps a copy of the
/// volume. One thread marks and sends, one receives, and neither ever waits. What finds no room, or exceeds
/// what a tick may copy, stays marked and is sent later as it is then, so that once everything marked has
/// been sent and received both sides are the same.
class DensityHandover {
 public:
  /// Room for `capacity` bricks (or a few more) on their way, 2 KiB each. Allocates everything.
  DensityHandover(const GridGeometry& geometry, std::size_t capacity);

  /// The milling thread: what changed has to be sent. Safe in the haptic tick.
  void mark(const VolumeChange& change) noexcept;
  /// The milling thread: copies up to `max` of the bricks marked, the longest marked first. Safe in the
  /// haptic tick.
  void send(const Volume& volume, std::size_t max) noexcept;
  /// How many bricks are marked and not sent. From any thread: those it does not count can be received.
  std::size_t waiting() const noexcept { return waiting_.load(std::memory_order_acquire); }

  /// The receiving thread: the next brick, its own until `pop`; null where there is none.
  DensityBlock* front() noexcept { return on_their_way_.front(); }
  void pop() noexcept { on_their_way_.pop(); }

 private:
  std::array<int, 3> brick_dims_;

  // Bricks marked: a flag each, and their numbers in a ring in the order in which they were marked.
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> order_;
  std::size_t next_ = 0;
  std::atomic<std::size_t> waiting_{0};

  SpscQueue<DensityBlock> on_their_way_;
};

/// Follows a bone that is being milled, for all who are not the haptic thread: the one copy of its densities
/// (which shares with it what was not milled), from which its surface is kept up on a thread of its own, cuts
/// are drawn, files are saved, and to which what was milled is given back. The haptic thread hands over what
/// changed and waits for nobody; the others wait for each other no longer than a few changed bricks take to
/// be put in place or meshed (the whole bone after another isovalue).
class BoneFollower {
 public:
  /// How many a tick copies at most, 16 KiB. All that a burr of 3 mm changes is sent within 20 ticks.
  static constexpr std::size_t kBricksPerTick = 8;
  /// The memory that cuts which can be taken back may take.
  static constexpr std::size_t kUndoBytes = std::size_t{256} << 20;

  /// Copies the bone and starts meshing all of it; has the memory made that milling it takes
  /// (Volume::prepare_about) ahead of the burr.
  explicit BoneFollower(std::shared_ptr<Volume> bone, std::size_t undo_bytes = kUndoBytes);

  /// What was milled of this bone at another time goes into both, as one cut. Before the first tick.
  void begin_with(const std::vector<DensityBlock>& milled);

  /// To be called by the haptic thread at every tick with the bone and what the tick changed of it, an empty
  /// change too: a part of what is to be copied may have been left to later ticks. Safe in the haptic tick:
  /// copies at most a few bricks of 2 KiB, and never waits, allocates or throws.
  void bone_changed(const Volume& bone, const VolumeChange& change) noexcept;

  const SurfaceBricks& layout() const { return layout_; }
  /// What changed of the surface since the last call. The first call that brings anything brings the whole
  /// surface. For one drawing thread; never waits for meshing.
  ChangedBricks take_changed_bricks();
  /// Has the whole surface meshed anew at another isovalue; of several in short order, at the last one. The
  /// bone's own isovalue stays. Any thread but the haptic one, as all that follows.
  void show_isovalue(double isovalue);

  /// Lets `use` read the bone as last handed over, some ticks behind; nothing is taken over meanwhile.
  void read(const std::function<void(const Volume&)>& use) const;
  /// Grows with every change of what is read.
  std::uint64_t version() const { return version_.load(std::memory_order_acquire); }

  /// What is milled from now on belongs to another cut; `removed_mm3` is what was removed before it.
  void begin_cut(double removed_mm3);
  /// How many cuts can be taken back, and whether anything was milled since the beginning.
  std::size_t cuts() const;
  bool touched() const;
  /// Every brick that was ever milled, as it is now.
  std::vector<DensityBlock> touched_bricks() const;
  /// By how much densities have fallen since the beginning, summed over each label's voxels, by its place;
  /// empty for a bone without labels.
  std::vector<double> drops_by_label() const;

  /// Takes over what has arrived. True where nothing is left to come, so that the copy is the bone, provided
  /// that the bone is held (LiveSession::hold_bone).
  bool catch_up();

  /// The copy, made ready to become the bone, and how much is then removed of it.
  struct NextBone {
    std::shared_ptr<Volume> bone;
    double removed_mm3;
    /// Where another isovalue makes them others.
    std::optional<BoneDensities> densities;
  };
  /// The copy with the last cut taken back, as it was at the beginning, or with another isovalue. With the
  /// last, what milling had emptied (cut down to `surroundings`) stays empty; throws std::invalid_argument
  /// where the isovalue is not finite. To be called while the bone is held and the copy is caught up; from
  /// then until `swap` or `give_up` nobody writes into either. The surface shows the change at once; the cut
  /// is gone with `swap`.
  NextBone without_last_cut();
  NextBone as_at_the_beginning();
  NextBone with_isovalue(double isovalue, double surroundings, double removed_mm3);
  /// The copy has become the bone. What was the bone, which no tick uses any more, becomes the copy, so that
  /// there are never more than the two.
  void swap();
  /// The copy becomes again what the bone is.
  void give_up();

 private:
  void keep_up(const std::stop_token& stop);
  void follow(const std::optional<double>& isovalue);
  void mesh();
  void take_over();
  bool put(DensityBlock& brick);
  void put_differing();
  NextBone without(const CutHistory::Before& cuts, void (CutHistory::*drop)());

  DensityHandover handover_;
  const SurfaceBricks layout_;
  std::atomic<std::uint64_t> version_{1};

  // Never taken by the haptic thread. Whoever writes holds it alone: into the copy or what goes with it, or
  // receives from the haptic thread.
  mutable std::shared_mutex bone_mutex_;
  // The bone that is milled: the haptic thread alone reads and writes its densities.
  std::shared_ptr<Volume> bone_;
  std::shared_ptr<Volume> copy_;
  VoxelBox arrived_;  // since the thread last looked
  CutHistory history_;
  SurfaceUpkeep upkeep_;
  double shown_isovalue_;
  // While the copy is to become the bone: how the two differ, and what of the history is then over.
  std::vector<DensityBlock> differing_;
  void (CutHistory::*drop_)() = nullptr;
  // The most that a voxel milled empty may have kept.
  float emptied_ = std::numeric_limits<float>::lowest();

  std::mutex mutex_;
  // What the drawing thread has not taken yet.
  ChangedBricks published_;
  std::condition_variable_any woken_;
  std::optional<double> new_isovalue_;
  // Last, so that it ends before all that it uses.
  std::jthread mesher_;
};

}  // namespace osteomill
