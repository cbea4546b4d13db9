#include "surface_mesher.h"

#include <chrono>
#include <utility>

namespace osteomill {

namespace {

using namespace std::chrono_literals;

// The haptic thread does not wake other threads (that would be a system call), so the mesher polls: more than
// 30 times a second, but rarely enough that a brick milled in every tick is not meshed in every tick.
constexpr auto kPollInterval = 20ms;

}  // namespace

SurfaceMesher::SurfaceMesher(const SurfaceBricks& layout, double isovalue)
    : upkeep_(layout), shown_isovalue_(isovalue) {}

void SurfaceMesher::mesh(const Volume& bone) {
  std::optional<double> isovalue;
  {
    const std::lock_guard lock(mutex_);
    isovalue = std::exchange(new_isovalue_, std::nullopt);
  }
  if (isovalue && *isovalue != shown_isovalue_) {
    shown_isovalue_ = *isovalue;
    upkeep_.mark_all();
  }
  ChangedBricks changed = upkeep_.remesh({bone.grid(), bone.ranges(), shown_isovalue_});
  const std::lock_guard lock(mutex_);
  // If a brick is in both, the newer one is kept.
  changed.merge(published_);
  published_ = std::move(changed);
}

void SurfaceMesher::wait(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  woken_.wait_for(lock, stop, kPollInterval, [this] { return new_isovalue_.has_value(); });
}

void SurfaceMesher::show_isovalue(double isovalue) {
  {
    const std::lock_guard lock(mutex_);
    new_isovalue_ = isovalue;
  }
  woken_.notify_one();
}

ChangedBricks SurfaceMesher::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(published_, {});
}

}  // namespace osteomill
