#include "osteomill/live/bone_follower.h"

#include <atomic>
#include <mutex>
#include <shared_mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "osteomill/base/work_progress.h"

#include "bone_copy.h"
#include "density_handover.h"
#include "surface_mesher.h"

namespace osteomill {

struct BoneFollower::Parts {
  Parts(std::shared_ptr<Volume> bone, std::size_t undo_bytes)
      : layout(bone->geometry().dims),
        handover(bone->geometry(), DensityHandover::kMaxBricksInFlight),
        surface(layout, bone->isovalue()),
        copy(std::move(bone), undo_bytes, [this](const VoxelBox& changed) {
          surface.mark(changed);
          version.fetch_add(1, std::memory_order_release);
        }) {}

  const SurfaceBricks layout;
  DensityHandover handover;
  std::atomic<std::uint64_t> version{1};
  SurfaceMesher surface;

  // Never locked by the haptic thread. Locked exclusively to write to the copy or to receive from the haptic
  // thread.
  mutable std::shared_mutex mutex;
  BoneCopy copy;
  VoxelBox arrived;  // since the follower's thread last checked
  // Last, so that the thread ends before the members it uses are destroyed.
  std::jthread thread;

  void drain_queue() {
    const VoxelBox changed = copy.drain_queue(handover);
    if (changed.empty()) return;
    arrived.include(changed.first);
    arrived.include(changed.last);
  }
  void follow() {
    std::shared_ptr<Volume> milled;
    VoxelBox where;
    {
      const std::lock_guard lock(mutex);
      drain_queue();
      milled = copy.bone();
      where = std::exchange(arrived, {});
    }
    milled->prefault_around(where);
  }
  // Other threads may read meanwhile; none marks bricks while another thread holds the lock.
  void mesh() {
    const std::shared_lock lock(mutex);
    surface.mesh(copy.volume());
  }
  void run(const std::stop_token& stop) {
    const WorkProgress meshing([&](double) {
      if (stop.stop_requested()) throw WorkStopped();
    });
    try {
      while (!stop.stop_requested()) {
        follow();
        mesh();
        surface.wait(stop);
      }
    } catch (const WorkStopped&) {
      // Stopped while meshing the whole bone.
    }
  }
};

BoneFollower::BoneFollower(std::shared_ptr<Volume> bone, std::size_t undo_bytes)
    : parts_(std::make_unique<Parts>(std::move(bone), undo_bytes)) {
  parts_->mesh();
  parts_->thread = std::jthread([parts = parts_.get()](const std::stop_token& stop) { parts->run(stop); });
}

BoneFollower::~BoneFollower() = default;

void BoneFollower::load_milled(const std::vector<DensityBlock>& milled,
                               const std::vector<double>& piece_drops) {
  const std::lock_guard lock(parts_->mutex);
  parts_->copy.load_milled(milled, piece_drops);
}

void BoneFollower::bone_changed(const Volume& bone, const VolumeChange& change) noexcept {
  parts_->handover.mark(change);
  parts_->handover.send(bone, kBricksPerTick);
}

const SurfaceBricks& BoneFollower::layout() const {
  return parts_->layout;
}

ChangedBricks BoneFollower::take_changed_bricks() {
  return parts_->surface.take();
}

void BoneFollower::show_isovalue(double isovalue) {
  parts_->surface.show_isovalue(isovalue);
}

void BoneFollower::read(const std::function<void(const Volume&)>& use) const {
  const std::shared_lock lock(parts_->mutex);
  use(parts_->copy.volume());
}

std::uint64_t BoneFollower::version() const {
  return parts_->version.load(std::memory_order_acquire);
}

void BoneFollower::begin_cut(double removed_mm3) {
  const std::lock_guard lock(parts_->mutex);
  parts_->drain_queue();
  parts_->copy.begin_cut(removed_mm3);
}

std::size_t BoneFollower::cuts() const {
  const std::shared_lock lock(parts_->mutex);
  return parts_->copy.history().cuts();
}

std::size_t BoneFollower::undone_cuts() const {
  const std::shared_lock lock(parts_->mutex);
  return parts_->copy.history().undone_cuts();
}

bool BoneFollower::is_touched() const {
  const std::shared_lock lock(parts_->mutex);
  return parts_->copy.history().is_touched();
}

std::vector<DensityBlock> BoneFollower::touched_bricks() const {
  const std::shared_lock lock(parts_->mutex);
  const CutHistory::Bricks& touched = parts_->copy.history().original_bricks();
  std::vector<DensityBlock> bricks;
  bricks.reserve(touched.size());
  for (const auto& [place, first] : touched) bricks.emplace_back(parts_->copy.volume().grid(), first.first);
  return bricks;
}

std::vector<double> BoneFollower::drops_by_label() const {
  const std::shared_lock lock(parts_->mutex);
  return parts_->copy.drops_by_label();
}

std::vector<double> BoneFollower::piece_drops() const {
  const std::shared_lock lock(parts_->mutex);
  return parts_->copy.history().piece_drops();
}

bool BoneFollower::catch_up() {
  const bool all_sent = parts_->handover.waiting_count() == 0;
  const std::lock_guard lock(parts_->mutex);
  parts_->drain_queue();
  return all_sent && parts_->handover.front() == nullptr;
}

BoneFollower::NextBone BoneFollower::without_last_cut(double removed_mm3) {
  const std::lock_guard lock(parts_->mutex);
  return parts_->copy.without_last_cut(removed_mm3);
}

BoneFollower::NextBone BoneFollower::with_undone_cut(double removed_mm3) {
  const std::lock_guard lock(parts_->mutex);
  return parts_->copy.with_undone_cut(removed_mm3);
}

BoneFollower::NextBone BoneFollower::without_pieces(const PieceRemoval& removal, double removed_mm3) {
  // Scans every voxel while others read.
  const Volume& bone = parts_->copy.volume();
  std::vector<DensityBlock> without =
      bricks_without(bone.grid(), bone.isovalue(), removal, parts_->copy.history().max_bricks());
  const std::lock_guard lock(parts_->mutex);
  return parts_->copy.without_pieces(std::move(without), removed_mm3);
}

BoneFollower::NextBone BoneFollower::without_all_cuts() {
  const std::lock_guard lock(parts_->mutex);
  return parts_->copy.without_all_cuts();
}

BoneFollower::NextBone BoneFollower::with_isovalue(double isovalue, double surroundings, double removed_mm3) {
  {
    const std::lock_guard lock(parts_->mutex);
    parts_->copy.set_isovalue(isovalue);
  }
  show_isovalue(isovalue);
  // Scans every voxel while others read.
  const BoneDensities densities = estimate_densities(parts_->copy.volume());
  const std::lock_guard lock(parts_->mutex);
  return parts_->copy.with_emptied(surroundings, removed_mm3, densities);
}

void BoneFollower::swap() {
  const std::lock_guard lock(parts_->mutex);
  parts_->copy.exchange();
}

void BoneFollower::discard_next() {
  const std::lock_guard lock(parts_->mutex);
  parts_->copy.discard_next();
  show_isovalue(parts_->copy.volume().isovalue());
}

}  // namespace osteomill
