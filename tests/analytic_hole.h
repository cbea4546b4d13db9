#pragma once

#include <algorithm>
#include <cmath>

#include "osteomill/base/wrench.h"
#include "osteomill/session/milling_entry.h"

namespace osteomill::testing_support {

/// Replaces algorithm and milling in tests of the operator: a floor perpendicular to the entry direction that
/// recedes under the burr's force while the spindle turns, walls that keep the burr's centre within 0.1 mm of
/// the axis, and a rim that stops the shaft at a tilt of 0.2 rad. All contacts are springs.
class AnalyticHole {
 public:
  struct Step {
    Wrench wrench;
    Pose X_WT;
    double floor_force_N;
  };
  enum class Kind { direct, line_proxy };

  /// `line_proxy`: as in the paper's first algorithm, the device's centre (not the burr's surface) contacts
  /// the floor, and the tool is drawn resting on it.
  AnalyticHole(const MillingEntry& entry, double burr_radius_mm, Kind kind, double yield_mm_per_Ns)
      : entry_(entry), burr_radius_mm_(burr_radius_mm), kind_(kind), yield_mm_per_Ns_(yield_mm_per_Ns) {}

  Step step(const Pose& X_WD, bool milling, double dt_s) {
    const Vec3 offset_mm = X_WD.position_mm - entry_.point_W;
    const double along_mm = entry_.direction_W.dot(offset_mm);
    const double reach_mm = kind_ == Kind::direct ? burr_radius_mm_ : 0.0;
    const double sunk_mm = std::max(0.0, along_mm + reach_mm - floor_mm_);
    Step step;
    step.floor_force_N = kStiffness * sunk_mm;
    step.X_WT = X_WD;
    // Draws the tool resting on the floor, with its centre one burr radius above.
    if (kind_ == Kind::line_proxy && sunk_mm > 0) {
      step.X_WT.position_mm -= (sunk_mm + burr_radius_mm_) * entry_.direction_W;
    }
    step.wrench.force_N = -step.floor_force_N * entry_.direction_W;
    if (sunk_mm > 0) add_walls(offset_mm - along_mm * entry_.direction_W, X_WD, step.wrench);
    if (milling) floor_mm_ += yield_mm_per_Ns_ * step.floor_force_N * dt_s;
    return step;
  }
  double floor_mm() const { return floor_mm_; }

 private:
  static constexpr double kStiffness = 2.0;              // N/mm
  static constexpr double kTorsionalStiffness = 1000.0;  // N mm/rad
  static constexpr double kPlay_mm = 0.1;
  static constexpr double kPlay_rad = 0.2;

  void add_walls(const Vec3& off_axis_mm, const Pose& X_WD, Wrench& wrench) const {
    const double off_mm = off_axis_mm.norm();
    if (off_mm > kPlay_mm) wrench.force_N -= kStiffness * (off_mm - kPlay_mm) / off_mm * off_axis_mm;
    const Vec3 axis = (-entry_.direction_W).cross(shaft_direction(X_WD));
    const double lean_rad = std::asin(std::min(1.0, axis.norm()));
    if (lean_rad > kPlay_rad) {
      wrench.torque_Nmm -= kTorsionalStiffness * (lean_rad - kPlay_rad) * axis.normalized();
    }
  }

  MillingEntry entry_;
  double burr_radius_mm_;
  Kind kind_;
  double yield_mm_per_Ns_;
  double floor_mm_ = 0;
};

}  // namespace osteomill::testing_support
