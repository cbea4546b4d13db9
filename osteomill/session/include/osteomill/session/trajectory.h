#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/session/device.h"

namespace osteomill {

/// The pose of a device at a time, and whether the spindle turned.
struct TrajectoryPoint {
  double time_s = 0;
  Pose X_WD;
  bool milling = false;
};

/// The greatest distance of a pose from the origin of W, along each axis: beyond any scanner and any device.
inline constexpr double kMaxPose_mm = 3e5;
/// Returns whether the pose is finite and not farther than that. Safe in the haptic tick.
inline bool is_reachable(const Pose& pose) {
  return is_finite(pose) && pose.position_mm.cwiseAbs().maxCoeff() <= kMaxPose_mm;
}

/// Reads CSV with the columns time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling (in any order; others are passed
/// over), one row a tick. Throws InputError naming the file and the row for a missing column, a value that is
/// not a finite number, a pose that is not reachable, a line of over 4096 bytes, a quaternion that is not of
/// unit length within 1e-3, milling other than 0 or 1, a time that does not go forward, a row with too few
/// values, or no row at all.
std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& path);

/// A device that gives the pose it was put at, and remembers the wrench it was sent: for replays and tests.
class PosedDevice : public Device {
 public:
  /// Sets what the device gives from the next reading on.
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
