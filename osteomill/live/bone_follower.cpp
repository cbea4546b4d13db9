#include "osteomill/live/bone_follower.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <limits>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <thread>
#include <utility>

#include "osteomill/live/cut_history.h"
#include "osteomill/live/density_handover.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

// The haptic thread wakes nobody (that would be a system call), so the follower looks by itself: oftener than
// 30 times a second, seldom enough that a brick milled at every tick is not meshed at every tick.
constexpr auto kLookEvery = 20ms;
// 1 MiB: what comes while the whole surface is meshed at a new isovalue.
constexpr std::size_t kBricksOnTheirWay = 511;

// What the drawing thread has not taken yet, each brick once.
class Published {
 public:
  void add(std::vector<ChangedBrick> changed) {
    const std::lock_guard lock(mutex_);
    for (ChangedBrick& brick : changed) bricks_.insert_or_assign(brick.brick, std::move(brick));
  }

  std::vector<ChangedBrick> take() {
    std::map<std::size_t, ChangedBrick> bricks;
    {
      const std::lock_guard lock(mutex_);
      bricks.swap(bricks_);
    }
    std::vector<ChangedBrick> taken;
    for (auto& [place, brick] : bricks) taken.push_back(std::move(brick));
    return taken;
  }

 private:
  std::mutex mutex_;
  std::map<std::size_t, ChangedBrick> bricks_;
};

}  // namespace

struct BoneFollower::Impl {
  Impl(std::shared_ptr<Volume> milled, std::size_t undo_bytes)
      : handover(milled->geometry(), kBricksOnTheirWay),
        layout(milled->geometry().dims),
        bone(std::move(milled)),
        copy(std::make_shared<Volume>(*bone)),
        history(undo_bytes),
        upkeep(layout),
        shown_isovalue(bone->isovalue()) {
    mesh();
    mesher = std::thread([this] { keep_up(); });
  }
  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    woken.notify_one();
    mesher.join();
  }

  void keep_up() {
    const WorkProgress meshing([this](double) {
      if (stopping) throw WorkStopped();
    });
    try {
      std::unique_lock lock(mutex);
      while (!stopping) {
        const auto isovalue = std::exchange(new_isovalue, std::nullopt);
        lock.unlock();
        follow(isovalue);
        mesh();
        lock.lock();
        woken.wait_for(lock, kLookEvery, [this] { return stopping || new_isovalue; });
      }
    } catch (const WorkStopped&) {
      // The whole bone was being meshed.
    }
  }

  void follow(const std::optional<double>& isovalue) {
    std::shared_ptr<Volume> milled;
    VoxelBox where;
    {
      const std::lock_guard lock(bone_mutex);
      if (isovalue && *isovalue != shown_isovalue) {
        shown_isovalue = *isovalue;
        upkeep.mark_all();
      }
      take_over();
      milled = bone;
      where = std::exchange(arrived, {});
    }
    milled->prepare_about(where);
  }

  // The others may read meanwhile; no other thread marks what is to be meshed while one holds the lock.
  void mesh() {
    const std::shared_lock lock(bone_mutex);
    published.add(upkeep.remesh({copy->grid(), copy->bricks(), shown_isovalue}));
  }

  // A bounded number, so that bricks which come as fast as they are taken cannot put off the meshing.
  void take_over() {
    DensityBlock* brick = handover.front();
    for (std::size_t n = 0; brick != nullptr && n < kBricksOnTheirWay; ++n) {
      if (put(*brick)) {
        history.keep(*brick);
        arrived.include(brick->first);
        arrived.include(brick->last());
      }
      handover.pop();
      brick = handover.front();
    }
  }

  // What was there is in the brick afterwards. False where nothing changed.
  bool put(DensityBlock& brick) {
    const VoxelBox changed = swap_densities(*copy, brick);
    if (changed.empty()) return false;
    upkeep.mark(changed);
    version.fetch_add(1, std::memory_order_release);
    return true;
  }

  // After it `differing` holds what was there.
  void put_differing() {
    for (DensityBlock& brick : differing) put(brick);
  }

  NextBone without(CutHistory::Taken cuts) {
    isovalue_before = copy->isovalue();
    taken = std::move(cuts);
    differing.clear();
    for (const auto& [place, brick] : taken->bricks) differing.push_back(brick);
    put_differing();
    return {copy, taken->removed_mm3, {}};
  }

  void show(double isovalue) {
    {
      const std::lock_guard lock(mutex);
      new_isovalue = isovalue;
    }
    woken.notify_one();
  }

  DensityHandover handover;
  const SurfaceBricks layout;
  Published published;
  std::atomic<std::uint64_t> version{1};

  // Never taken by the haptic thread. Whoever writes holds it alone: into the copy or what goes with it, or
  // receives from the haptic thread.
  mutable std::shared_mutex bone_mutex;
  // Milled by the haptic thread, which alone reads and writes its densities.
  std::shared_ptr<Volume> bone;
  std::shared_ptr<Volume> copy;
  VoxelBox arrived;  // since the thread last looked
  CutHistory history;
  SurfaceUpkeep upkeep;
  double shown_isovalue;
  // While the copy is to become the bone: how the two differ.
  std::vector<DensityBlock> differing;
  std::optional<CutHistory::Taken> taken;
  double isovalue_before = 0;
  // The most that a voxel milled empty may have kept.
  float emptied = std::numeric_limits<float>::lowest();

  std::mutex mutex;
  std::condition_variable woken;
  std::optional<double> new_isovalue;
  std::atomic<bool> stopping = false;
  std::thread mesher;
};

BoneFollower::BoneFollower(std::shared_ptr<Volume> bone, std::size_t undo_bytes)
    : impl_(std::make_unique<Impl>(std::move(bone), undo_bytes)) {}

BoneFollower::~BoneFollower() = default;

void BoneFollower::begin_with(const std::vector<DensityBlock>& milled) {
  const std::lock_guard lock(impl_->bone_mutex);
  for (DensityBlock brick : milled) {
    DensityBlock same = brick;
    swap_densities(*impl_->bone, same);
    if (impl_->put(brick)) impl_->history.keep(brick);
  }
}

void BoneFollower::bone_changed(const Volume& bone, const VolumeChange& change) noexcept {
  impl_->handover.mark(change);
  impl_->handover.send(bone, kBricksPerTick);
}

const SurfaceBricks& BoneFollower::layout() const {
  return impl_->layout;
}

std::vector<ChangedBrick> BoneFollower::take_changed_bricks() {
  return impl_->published.take();
}

void BoneFollower::show_isovalue(double isovalue) {
  impl_->show(isovalue);
}

void BoneFollower::read(const std::function<void(const Volume&)>& use) const {
  const std::shared_lock lock(impl_->bone_mutex);
  use(*impl_->copy);
}

std::uint64_t BoneFollower::version() const {
  return impl_->version.load(std::memory_order_acquire);
}

void BoneFollower::begin_cut(double removed_mm3) {
  const std::lock_guard lock(impl_->bone_mutex);
  impl_->take_over();
  impl_->history.begin_cut(removed_mm3);
}

std::size_t BoneFollower::cuts() const {
  const std::shared_lock lock(impl_->bone_mutex);
  return impl_->history.cuts();
}

bool BoneFollower::touched() const {
  const std::shared_lock lock(impl_->bone_mutex);
  return impl_->history.touched();
}

std::vector<DensityBlock> BoneFollower::touched_bricks() const {
  const std::shared_lock lock(impl_->bone_mutex);
  std::vector<DensityBlock> bricks;
  bricks.reserve(impl_->history.first().size());
  for (const auto& [place, first] : impl_->history.first()) {
    bricks.emplace_back(impl_->copy->grid(), first.first);
  }
  return bricks;
}

std::vector<double> BoneFollower::drops_by_label() const {
  const std::shared_lock lock(impl_->bone_mutex);
  const Volume& bone = *impl_->copy;
  if (!bone.labels()) return {};
  std::vector<double> drops(bone.labels()->labels().size() + 1);
  for (const auto& [place, first] : impl_->history.first()) {
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
  const bool all_sent = impl_->handover.waiting() == 0;
  const std::lock_guard lock(impl_->bone_mutex);
  impl_->take_over();
  return all_sent && impl_->handover.front() == nullptr;
}

BoneFollower::NextBone BoneFollower::without_last_cut() {
  const std::lock_guard lock(impl_->bone_mutex);
  return impl_->without(impl_->history.take_last());
}

BoneFollower::NextBone BoneFollower::as_at_the_beginning() {
  const std::lock_guard lock(impl_->bone_mutex);
  return impl_->without(impl_->history.take_all());
}

BoneFollower::NextBone BoneFollower::with_isovalue(double isovalue, double surroundings, double removed_mm3) {
  Volume& copy = *impl_->copy;
  {
    const std::lock_guard lock(impl_->bone_mutex);
    impl_->isovalue_before = copy.isovalue();
    copy.set_isovalue(isovalue);
    impl_->show(isovalue);
  }
  // Goes through every voxel, while others read.
  const BoneDensities densities = estimate_densities(copy);
  const std::lock_guard lock(impl_->bone_mutex);
  // Also at an isovalue before this one.
  impl_->emptied = std::max(impl_->emptied, static_cast<float>(surroundings));
  impl_->differing = impl_->history.keep_emptied(copy.grid(), impl_->emptied, isovalue,
                                                 static_cast<float>(densities.surroundings));
  impl_->put_differing();
  return {impl_->copy, removed_mm3, densities};
}

void BoneFollower::swap() {
  const std::lock_guard lock(impl_->bone_mutex);
  std::swap(impl_->bone, impl_->copy);
  const Volume& bone = *impl_->bone;
  for (const DensityBlock& brick : impl_->differing) {
    DensityBlock now(bone.grid(), brick.first);
    swap_densities(*impl_->copy, now);
  }
  impl_->copy->set_isovalue(bone.isovalue());
  impl_->differing.clear();
  impl_->taken.reset();
}

void BoneFollower::give_up() {
  const std::lock_guard lock(impl_->bone_mutex);
  impl_->put_differing();
  impl_->differing.clear();
  if (impl_->taken) impl_->history.put_back(*std::exchange(impl_->taken, std::nullopt));
  impl_->copy->set_isovalue(impl_->isovalue_before);
  impl_->show(impl_->isovalue_before);
}

}  // namespace osteomill
