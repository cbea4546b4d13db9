#pragma once

#include <algorithm>

#include "osteomill/session/device.h"

namespace osteomill::testing_support {

/// A device pushed along a line with a given force. It moves at `mm_per_Ns` times the push minus the force
/// sent to it, limited to kFastest_mm_s.
class PressingDevice final : public Device {
 public:
  static constexpr double kFastest_mm_s = 50;

  PressingDevice(const Pose& X_WD, const Vec3& along_W, double mm_per_Ns)
      : X_WD_(X_WD), along_W_(along_W), mm_per_Ns_(mm_per_Ns) {}

  void press(double push_N) { push_N_ = push_N; }

  Pose read_pose() noexcept override { return X_WD_; }
  void write_wrench(const Wrench& wrench) noexcept override { against_N_ = -wrench.force_N.dot(along_W_); }
  void tick_done(const Pose&, double dt_s) noexcept override {
    const double mm_s = std::clamp(mm_per_Ns_ * (push_N_ - against_N_), -kFastest_mm_s, kFastest_mm_s);
    X_WD_.position_mm += mm_s * dt_s * along_W_;
  }

 private:
  Pose X_WD_;
  Vec3 along_W_;
  double mm_per_Ns_;
  double push_N_ = 0;
  double against_N_ = 0;
};

}  // namespace osteomill::testing_support
