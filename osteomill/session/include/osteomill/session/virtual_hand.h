#pragma once

#include <cstdint>

#include "osteomill/base/latest_value.h"
#include "osteomill/session/device.h"
#include "osteomill/session/hand.h"
#include "osteomill/session/simulated_handle.h"

namespace osteomill {

/// A simulated device whose handle follows a pose set by another thread (from a mouse or a SpaceMouse). A
/// spring of limited force and a damper pull it there, so that bone can resist: a user without haptic
/// hardware sees the resistance.
///
/// `pull_to` is for one other thread and never blocks.
class VirtualHand final : public Device {
 public:
  /// Starts at rest at `X_WD`. Throws std::invalid_argument if a setting is invalid.
  VirtualHand(const HandleSettings& handle, const HandSettings& hand, const Pose& X_WD);

  /// Sets the target pose; ignores one that is not finite.
  void pull_to(const Pose& X_W_target) noexcept;
  /// Places hand and handle at rest at `X_WD`, where they stay until the next `pull_to`. For the haptic
  /// thread, between two ticks; real-time safe.
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
  // Number of the last pull that is ignored.
  std::uint64_t ignored_pulls_ = 0;
  // Current target of the hand. Follows the requested pose smoothly, because that changes only once per video
  // frame.
  Pose X_W_target_;
};

/// Returns a hand for pointing devices: the default stiffness, a push of up to 2.5 N, no tremor, and
/// critically damped with the default handle.
HandSettings pointing_hand();

}  // namespace osteomill
