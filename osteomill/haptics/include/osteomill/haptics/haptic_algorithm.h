#pragma once

#include <optional>
#include <string>
#include <vector>

#include "osteomill/base/nonblocking.h"
#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Inputs for `prepare`: the bone, and the tool that mills it. The volume must outlive the algorithm prepared
/// with it.
struct AlgorithmInputs {
  const Volume* volume = nullptr;
  MillingTool tool;
  /// The loop's nominal period. Derive stiffness and damping that a slower loop could not hold from it, never
  /// from the length of one tick, which may be late.
  double tick_period_s = 1e-3;
};

/// The result of one step of an algorithm.
struct HapticStep {
  /// The wrench on the hand, in W, about the burr's centre, before the device's limits are applied.
  Wrench wrench;
  /// The simulated tool, which is drawn and which cuts.
  Pose X_WT;
  /// The force of the burr (not the shaft) on the bone, in W; zero if something else holds the tool. Milling
  /// takes its energy from this force and cuts in its direction.
  Vec3 burr_force_W_N = Vec3::Zero();
  /// The point in W at which bone holds the tool's shaft, if the algorithm computes one: line-proxy gives the
  /// paper's intersection point (IP). For display only.
  std::optional<Vec3> intersection_W;
  /// Number of sample points (vertices, or points of the shell) in contact.
  int contacts = 0;
  /// Number of bricks whose points may show more bone than there is, because their update was deferred to
  /// later ticks.
  int pending_bricks = 0;
};

/// Computes a wrench from the device's pose. `prepare` is called first and may allocate; `step`,
/// `volume_changed` and `reset` are called only from the haptic thread and must never allocate, lock, log or
/// throw.
class HapticAlgorithm {
 public:
  virtual ~HapticAlgorithm() = default;

  /// Returns a line for each setting with which this tool is held poorly, or a tick takes too long, in a scan
  /// of this grid. Throws std::invalid_argument, naming setting and range, if bone could not hold it at all;
  /// `prepare` then throws the same.
  virtual std::vector<std::string> setting_warnings(const MillingTool&, const GridGeometry&) const {
    return {};
  }
  /// Prepares the algorithm for this bone and tool. Throws std::invalid_argument if a setting or the tool is
  /// out of range.
  virtual void prepare(const AlgorithmInputs& inputs) = 0;
  /// Computes one tick. `X_WD` is the device's pose as a tool pose in W (finite); `dt_s` is the time since
  /// the last step.
  virtual HapticStep step(const Pose& X_WD, double dt_s) noexcept OSTEOMILL_NONBLOCKING = 0;
  /// Updates the algorithm after the densities in `change` have fallen.
  virtual void volume_changed(const VolumeChange& change) noexcept OSTEOMILL_NONBLOCKING = 0;
  /// Forgets all contacts, as before the first step; the volume is unchanged.
  virtual void reset() noexcept OSTEOMILL_NONBLOCKING = 0;

  /// Returns the current number of sample points: vertices, or points of the shell. Not for the tick.
  virtual int sample_point_count() const = 0;

 protected:
  HapticAlgorithm() = default;
  // Protected to prevent slicing.
  HapticAlgorithm(const HapticAlgorithm&) = default;
  HapticAlgorithm& operator=(const HapticAlgorithm&) = default;
};

}  // namespace osteomill
