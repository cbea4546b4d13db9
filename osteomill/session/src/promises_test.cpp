#include <type_traits>
#include <utility>

#include <gtest/gtest.h>

#include "osteomill/session/milling_session.h"

namespace osteomill {
namespace {

// All functions called in the tick are noexcept, except those with which a device reports failure.
template <typename T>
T& a() noexcept;

static_assert(noexcept(a<HapticAlgorithm>().step(a<const Pose>(), 1e-3)));
static_assert(noexcept(a<HapticAlgorithm>().volume_changed(a<const VolumeChange>())));
static_assert(noexcept(a<HapticAlgorithm>().reset()));
static_assert(noexcept(a<Device>().delivered_fraction()) && noexcept(
    a<Device>().is_spindle_requested()) && noexcept(a<Device>().is_driven()));
static_assert(noexcept(a<Device>().tick_done(a<const Pose>(),
                                             1e-3)) && noexcept(a<Device>().put_at(a<const Pose>())));
static_assert(noexcept(a<Device>().disengage()) && noexcept(a<Device>().engage()));
static_assert(!noexcept(a<Device>().read_pose()) && !noexcept(a<MillingSession>().tick(a<Device>(), {})));
static_assert(noexcept(a<BurrMill>().step(a<const Vec3>(), a<const Vec3>(), 1e-3)));
static_assert(noexcept(a<WrenchGuard>().filter(a<const Wrench>(), a<const Pose>(), 1e-3)));
static_assert(noexcept(a<MillingSession>().resume_from(a<const SessionHandover>())));

// Copying through the interface would slice.
static_assert(!std::is_copy_assignable_v<Device> && !std::is_copy_assignable_v<HapticAlgorithm>);
static_assert(std::is_nothrow_swappable_v<Volume>);

class FailedDevice final : public Device {
 public:
  Pose read_pose() override { return {}; }
  void write_wrench(const Wrench&) override { throw 1; }
};

TEST(Device, DisengageReturnsFalseIfWritingTheWrenchThrows) {
  EXPECT_FALSE(FailedDevice().disengage());
}

}  // namespace
}  // namespace osteomill
