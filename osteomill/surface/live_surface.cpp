#include "osteomill/surface/live_surface.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "osteomill/surface/density_handover.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

// The haptic thread wakes nobody (that would be a system call), so the surface looks by itself: oftener than
// 30 times a second, seldom enough that a brick milled at every tick is not meshed at every tick.
constexpr auto kLookEvery = 20ms;
// 1 MiB: what comes while the whole surface is meshed at a new isovalue.
constexpr std::size_t kBricksOnTheirWay = 512;

// What the drawing thread has not taken yet, each brick once.
class Published {
 public:
  explicit Published(std::size_t bricks) : place_(bricks, -1) {}

  void add(std::vector<ChangedBrick> changed) {
    const std::lock_guard lock(mutex_);
    for (ChangedBrick& brick : changed) {
      std::int32_t& place = place_[brick.brick];
      if (place >= 0) {
        std::swap(bricks_[static_cast<std::size_t>(place)].mesh, brick.mesh);
      } else {
        place = static_cast<std::int32_t>(bricks_.size());
        bricks_.push_back(std::move(brick));
      }
    }
  }

  std::vector<ChangedBrick> take() {
    std::vector<ChangedBrick> taken;
    {
      const std::lock_guard lock(mutex_);
      taken.swap(bricks_);
      for (const ChangedBrick& brick : taken) place_[brick.brick] = -1;
    }
    std::sort(taken.begin(), taken.end(),
              [](const ChangedBrick& a, const ChangedBrick& b) { return a.brick < b.brick; });
    return taken;
  }

 private:
  std::mutex mutex_;
  std::vector<ChangedBrick> bricks_;
  std::vector<std::int32_t> place_;  // by brick: where it stands in bricks_, or -1
};

}  // namespace

struct LiveSurface::Impl {
  explicit Impl(const Volume& volume)
      : copy(volume), handover(volume.geometry(), kBricksOnTheirWay), published(copy.layout().count()) {
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
    std::unique_lock lock(mutex);
    while (!stopping) {
      if (const auto isovalue = std::exchange(new_isovalue, std::nullopt)) copy.set_isovalue(*isovalue);
      lock.unlock();
      take_over();
      published.add(copy.remesh());
      lock.lock();
      woken.wait_for(lock, kLookEvery, [this] { return stopping || new_isovalue; });
    }
  }

  // A bounded number, so that bricks which come as fast as they are taken cannot put off the meshing.
  void take_over() {
    const DensityHandover::Brick* brick = handover.front();
    for (std::size_t n = 0; brick != nullptr && n < kBricksOnTheirWay; ++n) {
      copy.put(*brick);
      handover.pop();
      brick = handover.front();
    }
  }

  SurfaceCopy copy;
  DensityHandover handover;
  Published published;

  std::mutex mutex;
  std::condition_variable woken;
  std::optional<double> new_isovalue;
  bool stopping = false;
  std::thread mesher;
};

LiveSurface::LiveSurface(const Volume& volume) : impl_(std::make_unique<Impl>(volume)) {}

LiveSurface::~LiveSurface() = default;

const SurfaceBricks& LiveSurface::layout() const {
  return impl_->copy.layout();
}

void LiveSurface::volume_changed(const Volume& volume, const VolumeChange& change) noexcept {
  impl_->handover.mark(change);
  impl_->handover.send(volume, LiveSurface::kBricksPerTick);
}

std::vector<ChangedBrick> LiveSurface::take_changed_bricks() {
  return impl_->published.take();
}

void LiveSurface::set_isovalue(double isovalue) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->new_isovalue = isovalue;
  }
  impl_->woken.notify_one();
}

}  // namespace osteomill
