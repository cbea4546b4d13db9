#include "osteomill/session/virtual_hand.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

namespace {

// Rate at which the target follows the requested pose: about two video frames.
constexpr double kFollow_per_s = 30.0;
constexpr double kMaxTick_s = 0.05;

}  // namespace

HandSettings pointing_hand() {
  HandSettings hand;
  hand.push_N = 2.5;
  // Critical damping, 2 sqrt(k m), with the default handle, in translation and rotation.
  hand.damping_Ns_per_mm = 0.0245;
  hand.torsional_damping_Nmms_per_rad = 24.5;
  hand.tremor_mm = 0;
  return hand;
}

VirtualHand::VirtualHand(const HandleSettings& handle, const HandSettings& hand, const Pose& X_WD)
    : hand_(hand), handle_(handle, X_WD), X_W_target_(X_WD) {
  require_valid(hand);
}

void VirtualHand::pull_to(const Pose& X_W_target) noexcept {
  if (is_finite(X_W_target)) pull_target_.write({X_W_target, ++pull_count_});
}

void VirtualHand::put_at(const Pose& X_WD) noexcept {
  if (!is_finite(X_WD)) return;
  handle_.reset(X_WD);
  X_W_target_ = X_WD;
  ignored_pulls_ = pull_target_.read().number;
}

void VirtualHand::tick_done(const Pose& /*X_WT*/, double dt_s) noexcept {
  const double passed_s = std::clamp(dt_s, 0.0, kMaxTick_s);
  const PullTarget& target = pull_target_.read();
  const Pose& X_W_goal = target.number > ignored_pulls_ ? target.X_W : X_W_target_;
  const double share = 1 - std::exp(-kFollow_per_s * passed_s);
  X_W_target_.position_mm += share * (X_W_goal.position_mm - X_W_target_.position_mm);
  X_W_target_.orientation = X_W_target_.orientation.slerp(share, X_W_goal.orientation).normalized();
  const auto substeps = static_cast<int>(std::lround(passed_s / handle_.settings().substep_s));
  for (int n = 0; n < substeps; ++n) {
    handle_.advance(hand_wrench(hand_, X_W_target_, Twist{}, handle_.pose(), handle_.velocity()));
  }
}

}  // namespace osteomill
