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

/// The bone of a recording after any of its ticks, density by density: milled again from the nearest of its
/// checkpoints, which keep the bricks that changed. Each tick that is milled is held against the recording.
/// For one thread at a time.
class RecordedBone {
 public:
  /// The most memory for bricks at checkpoints. If more would be needed, every second checkpoint is given up;
  /// only if each milled brick was kept once, and that is more, is it exceeded.
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
  /// Is told of voxels that may have changed.
  using OnChange = std::function<void(const VoxelBox&)>;

  /// Mills the whole recording; the bone is then as at its end. `scan` is as it was read; `recording`
  /// outlives this object. Throws InputError as `repeat_milling` does. Long work.
  RecordedBone(const Volume& scan, const Recording& recording, std::size_t max_bytes = kMaxBytes);
  ~RecordedBone();

  const Volume& bone() const { return bone_; }
  /// Returns after how many of the recording's ticks the bone is as it was.
  std::size_t ticks() const { return ticks_; }
  /// Makes the bone as it was after the first `ticks` (0: as scanned). The isovalue is that of the session.
  void go_to(std::size_t ticks, const OnChange& changed = {});

  std::size_t checkpoints() const { return checkpoints_.size(); }
  /// Returns the memory of the bricks at the checkpoints.
  std::size_t bytes() const { return kept_bricks_ * sizeof(DensityBlock); }

 private:
  struct Checkpoint {
    std::size_t ticks;
    BurrMill::Memory mill;
  };
  // Bricks after these numbers of ticks.
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
  // By their first voxels.
  std::map<std::size_t, Versions> bricks_;
  std::size_t kept_bricks_ = 0;
  std::size_t every_ticks_;
  std::vector<Checkpoint> checkpoints_;
  std::unique_ptr<RepeatedSession> session_;
  std::size_t ticks_ = 0;
};

}  // namespace osteomill
