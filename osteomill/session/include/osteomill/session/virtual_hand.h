#pragma once

#include <cstdint>

#include "osteomill/base/latest_value.h"
#include "osteomill/session/device.h"
#include "osteomill/session/hand.h"
#include "osteomill/session/simulated_handle.h"

namespace osteomill {

/// A simulated device whose handle follows a pose that another thread sets (from a mouse or a SpaceMouse). It
/// is pulled there by a spring of limited force and a damper, so that bone can hold it back: a user without
/// haptic hardware sees the resistance.
///
/// `pull_to` is for one other thread and never waits.
class VirtualHand final : public Device {
 public:
  /// Begins at rest at `X_WD`. Throws std::invalid_argument as SimulatedHandle and the hand's settings do.
  VirtualHand(const HandleSettings& handle, const HandSettings& hand, const Pose& X_WD);

  /// Sets the pose to pull to; one that is not finite is ignored.
  void pull_to(const Pose& X_W_target) noexcept;
  /// Puts hand and handle at `X_WD`, at rest, where they stay until the next `pull_to`. For the haptic
  /// thread, between two ticks; safe in the tick.
  void put_at(const Pose& X_WD) noexcept override;

  Pose read_pose() noexcept override { return handle_.read(); }
  void write_wrench(const Wrench& wrench) noexcept override { handle_.command(wrench); }
  void tick_done(const Pose& X_WT, double dt_s) noexcept override;

 private:
  HandSettings hand_;
  SimulatedHandle handle_;
  struct PullTarget {
    Pose X_W;
    std::uint64_t number = 0;
  };
  LatestValue<PullTarget> pull_target_;
  std::uint64_t pull_count_ = 0;
  // The last pull that does not count any more.
  std::uint64_t ignored_pulls_ = 0;
  // The pose that the hand pulls to now. It follows smoothly what is asked for, which comes only with every
  // picture.
  Pose X_W_target_;
};

/// Returns a hand for pointing devices: as firm as the simulated operator's, without tremor, and damped so
/// that it does not swing with the default handle.
HandSettings pointing_hand();

}  // namespace osteomill
