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

/// The surroundings that an algorithm is prepared for: the bone, and the tool that mills it. The volume
/// outlives the algorithm that was prepared with it.
struct AlgorithmInputs {
  const Volume* volume = nullptr;
  MillingTool tool;
  /// The loop's nominal period: stiffness that a slower loop cannot hold follows it, never the length of one
  /// tick, which may be late.
  double tick_period_s = 1e-3;
};

/// The result of one step of an algorithm.
struct HapticStep {
  /// The wrench as it acts on the hand, in W, about the burr's centre; before the device's limits are
  /// applied.
  Wrench wrench;
  /// The simulated tool: where the tool is drawn and where it cuts.
  Pose X_WT;
  /// The force with which the burr (not the shaft) presses on the bone, in W; zero if something else holds
  /// the tool. Milling is paid with it and cuts in its direction.
  Vec3 burr_force_W_N = Vec3::Zero();
  /// The point in W at which bone holds the tool's shaft, if the algorithm knows one: line-proxy gives the
  /// paper's intersection point (IP). It is drawn; nothing is computed from it.
  std::optional<Vec3> intersection_W;
  /// The number of sample points (vertices, or points of the shell) that touch.
  int contacts = 0;
  /// The number of bricks of bone points that may have shown more bone than there was, because bringing them
  /// up to date was left to later ticks.
  int pending_bricks = 0;
};

/// One way to turn the device's pose into a wrench. `prepare` comes first and may allocate; `step`,
/// `volume_changed` and `reset` are called from the haptic thread alone and never allocate, lock, log or
/// throw.
class HapticAlgorithm {
 public:
  virtual ~HapticAlgorithm() = default;

  /// Returns a line for each setting with which this tool holds badly, or takes too long, in a scan of this
  /// grid. Throws std::invalid_argument, naming setting and range, if bone could not hold it at all; then
  /// `prepare` throws the same.
  virtual std::vector<std::string> setting_warnings(const MillingTool&, const GridGeometry&) const {
    return {};
  }
  /// Makes the algorithm ready for this bone and tool. Throws std::invalid_argument if a setting or the tool
  /// is out of range.
  virtual void prepare(const AlgorithmInputs& inputs) = 0;
  /// Computes one tick. `X_WD` is the device's pose as a tool pose in W (finite); `dt_s` is the time since
  /// the last step.
  virtual HapticStep step(const Pose& X_WD, double dt_s) noexcept OSTEOMILL_NONBLOCKING = 0;
  /// Follows the volume, whose densities fell in `change`.
  virtual void volume_changed(const VolumeChange& change) noexcept OSTEOMILL_NONBLOCKING = 0;
  /// Forgets all contacts, as before the first step; the volume stays as it is.
  virtual void reset() noexcept OSTEOMILL_NONBLOCKING = 0;

  /// Returns how many sample points it works with: vertices, or points of the shell as it stands. Not for the
  /// tick.
  virtual int sample_point_count() const = 0;

 protected:
  HapticAlgorithm() = default;
  // Not through the interface, which would copy a part.
  HapticAlgorithm(const HapticAlgorithm&) = default;
  HapticAlgorithm& operator=(const HapticAlgorithm&) = default;
};

}  // namespace osteomill
