#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/session/device.h"

namespace osteomill {

/// Pose of a device at a time, and whether the spindle was on.
struct TrajectoryPoint {
  double time_s = 0;
  Pose X_WD;
  bool milling = false;
};

/// Maximum distance of a pose from the origin of W along each axis; larger than any scanner or device.
inline constexpr double kMaxPose_mm = 3e5;
/// Returns whether the pose is finite and within kMaxPose_mm. Safe in the haptic tick.
inline bool is_reachable(const Pose& pose) {
  return is_finite(pose) && pose.position_mm.cwiseAbs().maxCoeff() <= kMaxPose_mm;
}

/// Reads CSV with the columns time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling (in any order; others are ignored),
/// one row per tick. Throws InputError with the file and the row for a missing column, a value that is not a
/// finite number, a pose out of reach (`is_reachable`), a line of more than 4096 bytes, a quaternion whose
/// length differs from 1 by more than 1e-3, milling other than 0 or 1, a time that does not increase, a row
/// whose number of values differs from the header's, or a file without rows.
std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& path);

/// Device with a settable pose that stores the last wrench. For replays and tests.
class PosedDevice : public Device {
 public:
  /// Sets the values returned from the next reading on.
  void put(const Pose& X_WD, double delivered_fraction = 1, bool is_driven = true) noexcept {
    pose_ = X_WD;
    delivered_fraction_ = delivered_fraction;
    is_driven_ = is_driven;
  }
  const Wrench& sent() const noexcept { return sent_; }

  Pose read_pose() noexcept override { return pose_; }
  void write_wrench(const Wrench& wrench) noexcept override { sent_ = wrench; }
  double delivered_fraction() const noexcept override { return delivered_fraction_; }
  bool is_driven() const noexcept override { return is_driven_; }

 private:
  Pose pose_;
  double delivered_fraction_ = 1;
  bool is_driven_ = true;
  Wrench sent_;
};

}  // namespace osteomill
