#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "osteomill/milling/burr_mill.h"
#include "osteomill/recording/recording.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

class RepeatedSession;

/// Bone of a recording after any of its ticks, bit for bit: milled again from the nearest checkpoint before
/// it. Checkpoints store the bricks that changed. Compares each milled tick with the recording. For one
/// thread at a time.
class RecordedBone {
 public:
  /// Memory limit for bricks at checkpoints. If more would be needed, every second checkpoint is dropped.
  /// Exceeded only if storing each milled brick once takes more.
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
  /// Called with a box of voxels that may have changed.
  using OnChange = std::function<void(const VoxelBox&)>;

  /// Mills the whole recording, so that the bone is in its final state. `scan` is the scan as read;
  /// `recording` must outlive this object. Throws InputError as `repeat_milling` does. Long work.
  RecordedBone(const Volume& scan, const Recording& recording, std::size_t max_bytes = kMaxBytes);
  ~RecordedBone();

  const Volume& bone() const { return bone_; }
  /// Returns the number of ticks after which the recording's bone was in the current state.
  std::size_t ticks() const { return ticks_; }
  /// Sets the bone to its state after the first `ticks` ticks (0: as scanned), with the isovalue of that
  /// tick's session. `changed` may be empty.
  void go_to(std::size_t ticks, const OnChange& changed = {});

  std::size_t checkpoints() const { return checkpoints_.size(); }
  /// Returns the memory of the bricks at the checkpoints, bytes.
  std::size_t bytes() const { return kept_bricks_ * sizeof(DensityBlock); }

 private:
  struct Checkpoint {
    std::size_t ticks;
    BurrMill::Memory mill;
  };
  // Versions of a brick, each with the tick count after which it was stored.
  using Versions = std::vector<std::pair<std::size_t, std::unique_ptr<DensityBlock>>>;

  void mill_next(const OnChange& changed);
  void begin_session(std::size_t session, const OnChange& changed);
  void restore(std::size_t ticks, const OnChange& changed);
  void put(DensityBlock brick, const OnChange& changed);
  void add_checkpoint(const std::set<std::size_t>& changed);
  void drop_every_second_checkpoint();

  Volume scan_;
  Volume bone_;
  const Recording& recording_;
  std::size_t max_bytes_;
  // Key: linear index of the brick's first voxel.
  std::map<std::size_t, Versions> bricks_;
  std::size_t kept_bricks_ = 0;
  std::size_t every_ticks_;
  std::vector<Checkpoint> checkpoints_;
  std::unique_ptr<RepeatedSession> session_;
  std::size_t ticks_ = 0;
};

}  // namespace osteomill
