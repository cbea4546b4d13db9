#pragma once

#include <algorithm>

#include "osteomill/session/device.h"

namespace osteomill::testing_support {

/// A device that descends along z from free space, 8 mm/s at 1 kHz, to a given height; a session drives a
/// device only once it was out of bone. After put_at it stays at that pose.
class DescendingDevice : public Device {
 public:
  static constexpr double kFrom_mm = 3;
  explicit DescendingDevice(double down_to_mm) : down_to_mm_(down_to_mm) {}

  Pose X_WD{{0, 0, kFrom_mm}, Quat::Identity()};

  Pose read_pose() override {
    double& z_mm = X_WD.position_mm.z();
    if (!is_put_) z_mm = std::max(z_mm - 0.008, std::min(z_mm, down_to_mm_));
    return X_WD;
  }
  void write_wrench(const Wrench& /*wrench*/) override {}
  void put_at(const Pose& X_WD_put) noexcept override {
    X_WD = X_WD_put;
    is_put_ = true;
  }
  /// Restarts the descent.
  void lift() {
    X_WD.position_mm.z() = kFrom_mm;
    is_put_ = false;
  }

 private:
  double down_to_mm_;
  bool is_put_ = false;
};

}  // namespace osteomill::testing_support
