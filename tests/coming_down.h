#pragma once

#include <algorithm>

#include "osteomill/session/device.h"

namespace osteomill::testing_support {

/// A hand that comes down along z from free space at 8 mm/s and then holds the burr where the test wants it,
/// as every device that begins to be driven has to. Put elsewhere it stays there.
class ComingDown : public Device {
 public:
  static constexpr double kFrom_mm = 3;
  explicit ComingDown(double down_to_mm) : down_to_mm_(down_to_mm) {}

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
  /// It begins above again.
  void lift() {
    X_WD.position_mm.z() = kFrom_mm;
    is_put_ = false;
  }

 private:
  double down_to_mm_;
  bool is_put_ = false;
};

}  // namespace osteomill::testing_support
