#pragma once

#include "osteomill/device/device.h"

namespace osteomill {

/// A device that is where it is put, and remembers what it was sent: for replays and tests.
class PosedDevice : public Device {
 public:
  void put(const Pose& X_WD) { pose_ = X_WD; }
  const Wrench& sent() const { return sent_; }

  Pose read_pose() override { return pose_; }
  void write_wrench(const Wrench& wrench) override { sent_ = wrench; }

 private:
  Pose pose_;
  Wrench sent_;
};

}  // namespace osteomill
