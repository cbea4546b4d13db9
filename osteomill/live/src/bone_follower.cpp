#include "osteomill/live/bone_follower.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "osteomill/base/work_progress.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

// The haptic thread wakes nobody (that would be a system call), so the follower looks by itself: oftener than
// 30 times a second, seldom enough that a brick milled at every tick is not meshed at every tick.
constexpr auto kLookEvery = 20ms;
// 1 MiB: what comes while the whole surface is meshed at a new isovalue.
constexpr std::size_t kBricksOnTheirWay = 511;

}  // namespace

DensityHandover::DensityHandover(const GridGeometry& geometry, std::size_t capacity)
    : brick_dims_(geometry.all_voxels().bricks(DensityBlock::kVoxels).dims()),
      marked_(cell_count(brick_dims_)),
      order_(cell_count(brick_dims_)),
      on_their_way_(std::max<std::size_t>(capacity, 1)) {}

void DensityHandover::mark(const VolumeChange& change) noexcept {
  const VoxelBox& box = change.voxels;
  if (box.empty()) return;
  std::size_t waiting = waiting_.load(std::memory_order_relaxed);
  for_each(box.bricks(DensityBlock::kVoxels), [&](const VoxelIndex& brick) {
    const auto number = static_cast<std::uint32_t>(row_major(brick_dims_, brick.i, brick.j, brick.k));
    if (marked_[number]) return;
    marked_[number] = 1;
    order_[(next_ + waiting) % order_.size()] = number;
    ++waiting;
  });
  waiting_.store(waiting, std::memory_order_release);
}

void DensityHandover::send(const Volume& volume, std::size_t max) noexcept {
  std::size_t waiting = waiting_.load(std::memory_order_relaxed);
  for (std::size_t n = 0; n < max && waiting > 0; ++n) {
    const std::uint32_t number = order_[next_];
    const auto [bi, bj, bk] = cell_at(brick_dims_, number);
    const VoxelBox voxels = VoxelBox::of_brick({bi, bj, bk}, DensityBlock::kVoxels);
    if (!on_their_way_.try_push(volume.grid(), voxels.first)) break;
    next_ = (next_ + 1) % order_.size();
    --waiting;
    marked_[number] = 0;
  }
  waiting_.store(waiting, std::memory_order_release);
}

BoneFollower::BoneFollower(std::shared_ptr<Volume> bone, std::size_t undo_bytes)
    : handover_(bone->geometry(), kBricksOnTheirWay),
      layout_(bone->geometry().dims),
      bone_(std::move(bone)),
      copy_(std::make_shared<Volume>(*bone_)),
      history_(undo_bytes),
      upkeep_(layout_),
      shown_isovalue_(bone_->isovalue()) {
  mesh();
  mesher_ = std::jthread([this](const std::stop_token& stop) { keep_up(stop); });
}

void BoneFollower::keep_up(const std::stop_token& stop) {
  const WorkProgress meshing([&](double) {
    if (stop.stop_requested()) throw WorkStopped();
  });
  try {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
      const auto isovalue = std::exchange(new_isovalue_, std::nullopt);
      lock.unlock();
      follow(isovalue);
      mesh();
      lock.lock();
      woken_.wait_for(lock, stop, kLookEvery, [this] { return new_isovalue_.has_value(); });
    }
  } catch (const WorkStopped&) {
    // The whole bone was being meshed.
  }
}

void BoneFollower::follow(const std::optional<double>& isovalue) {
  std::shared_ptr<Volume> milled;
  VoxelBox where;
  {
    const std::lock_guard lock(bone_mutex_);
    if (isovalue && *isovalue != shown_isovalue_) {
      shown_isovalue_ = *isovalue;
      upkeep_.mark_all();
    }
    take_over();
    milled = bone_;
    where = std::exchange(arrived_, {});
  }
  milled->prepare_about(where);
}

// The others may read meanwhile; no other thread marks what is to be meshed while one holds the lock.
void BoneFollower::mesh() {
  const std::shared_lock lock(bone_mutex_);
  ChangedBricks changed = upkeep_.remesh({copy_->grid(), copy_->ranges(), shown_isovalue_});
  const std::lock_guard publishing(mutex_);
  // Of a brick that is in both, the newer stays.
  changed.merge(published_);
  published_ = std::move(changed);
}

// At most so many bricks, or those that come as fast as they are taken would put off the meshing for ever.
void BoneFollower::take_over() {
  DensityBlock* brick = handover_.front();
  for (std::size_t n = 0; brick != nullptr && n < kBricksOnTheirWay; ++n) {
    if (put(*brick)) {
      history_.keep(*brick);
      arrived_.include(brick->first);
      arrived_.include(brick->last());
    }
    handover_.pop();
    brick = handover_.front();
  }
}

// Puts the brick's densities into the copy and those that were there into the brick. Returns false where
// nothing changed.
bool BoneFollower::put(DensityBlock& brick) {
  const VoxelBox changed = swap_densities(*copy_, brick);
  if (changed.empty()) return false;
  upkeep_.mark(changed);
  version_.fetch_add(1, std::memory_order_release);
  return true;
}

// `differing_` holds afterwards what was there, so that the same call takes it back.
void BoneFollower::put_differing() {
  for (DensityBlock& brick : differing_) put(brick);
}

BoneFollower::NextBone BoneFollower::without(const CutHistory::Before& cuts, void (CutHistory::*drop)()) {
  drop_ = drop;
  for (const auto& [place, brick] : cuts.bricks) differing_.push_back(brick);
  put_differing();
  return {copy_, cuts.removed_mm3, {}};
}

void BoneFollower::begin_with(const std::vector<DensityBlock>& milled) {
  const std::lock_guard lock(bone_mutex_);
  for (DensityBlock brick : milled) {
    DensityBlock same = brick;
    swap_densities(*bone_, same);
    if (put(brick)) history_.keep(brick);
  }
}

void BoneFollower::bone_changed(const Volume& bone, const VolumeChange& change) noexcept {
  handover_.mark(change);
  handover_.send(bone, kBricksPerTick);
}

ChangedBricks BoneFollower::take_changed_bricks() {
  const std::lock_guard lock(mutex_);
  return std::exchange(published_, {});
}

void BoneFollower::show_isovalue(double isovalue) {
  {
    const std::lock_guard lock(mutex_);
    new_isovalue_ = isovalue;
  }
  woken_.notify_one();
}

void BoneFollower::read(const std::function<void(const Volume&)>& use) const {
  const std::shared_lock lock(bone_mutex_);
  use(*copy_);
}

void BoneFollower::begin_cut(double removed_mm3) {
  const std::lock_guard lock(bone_mutex_);
  take_over();
  history_.begin_cut(removed_mm3);
}

std::size_t BoneFollower::cuts() const {
  const std::shared_lock lock(bone_mutex_);
  return history_.cuts();
}

bool BoneFollower::touched() const {
  const std::shared_lock lock(bone_mutex_);
  return history_.touched();
}

std::vector<DensityBlock> BoneFollower::touched_bricks() const {
  const std::shared_lock lock(bone_mutex_);
  std::vector<DensityBlock> bricks;
  bricks.reserve(history_.first().size());
  for (const auto& [place, first] : history_.first()) {
    bricks.emplace_back(copy_->grid(), first.first);
  }
  return bricks;
}

std::vector<double> BoneFollower::drops_by_label() const {
  const std::shared_lock lock(bone_mutex_);
  const Volume& bone = *copy_;
  if (!bone.labels()) return {};
  std::vector<double> drops(bone.labels()->labels().size() + 1);
  for (const auto& [place, first] : history_.first()) {
    const float* before = first.densities.data();
    for_each({first.first, first.last()}, [&](const VoxelIndex& v) {
      const LabelMap::Place label = bone.labels()->at(v);
      if (label != 0) drops[label] += static_cast<double>(*before) - static_cast<double>(bone.grid()[v]);
      ++before;
    });
  }
  return drops;
}

bool BoneFollower::catch_up() {
  const bool all_sent = handover_.waiting() == 0;
  const std::lock_guard lock(bone_mutex_);
  take_over();
  return all_sent && handover_.front() == nullptr;
}

BoneFollower::NextBone BoneFollower::without_last_cut() {
  const std::lock_guard lock(bone_mutex_);
  return without(history_.before_last(), &CutHistory::drop_last);
}

BoneFollower::NextBone BoneFollower::as_at_the_beginning() {
  const std::lock_guard lock(bone_mutex_);
  return without(history_.before_all(), &CutHistory::drop_all);
}

BoneFollower::NextBone BoneFollower::with_isovalue(double isovalue, double surroundings, double removed_mm3) {
  Volume& copy = *copy_;
  {
    const std::lock_guard lock(bone_mutex_);
    copy.set_isovalue(isovalue);
    show_isovalue(isovalue);
  }
  // Goes through every voxel, while others read.
  const BoneDensities densities = estimate_densities(copy);
  const std::lock_guard lock(bone_mutex_);
  // Also at an isovalue before this one.
  emptied_ = std::max(emptied_, static_cast<float>(surroundings));
  differing_ =
      history_.keep_emptied(copy.grid(), emptied_, isovalue, static_cast<float>(densities.surroundings));
  put_differing();
  return {copy_, removed_mm3, densities};
}

void BoneFollower::swap() {
  const std::lock_guard lock(bone_mutex_);
  if (drop_ != nullptr) (history_.*std::exchange(drop_, nullptr))();
  std::swap(bone_, copy_);
  const Volume& bone = *bone_;
  for (const DensityBlock& brick : differing_) {
    DensityBlock now(bone.grid(), brick.first);
    swap_densities(*copy_, now);
  }
  copy_->set_isovalue(bone.isovalue());
  differing_.clear();
}

void BoneFollower::give_up() {
  const std::lock_guard lock(bone_mutex_);
  put_differing();
  differing_.clear();
  drop_ = nullptr;
  copy_->set_isovalue(bone_->isovalue());
  show_isovalue(bone_->isovalue());
}

}  // namespace osteomill
