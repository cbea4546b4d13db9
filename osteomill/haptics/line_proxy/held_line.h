#pragma once

#include <array>
#include <optional>

#include "osteomill/haptics/line_proxy/shaft_contact.h"
#include "osteomill/haptics/tool_move.h"

namespace osteomill::line_proxy {

/// What holds the line to the device's: the spring of eq. 6 at its tip, and one about its orientation.
struct LineSprings {
  double tip_N_per_mm = 1;
  double turning_Nmm_per_rad = 1;
};

/// The tool's centreline as it follows the device's as far as bone lets it, tip, flank and far end: a
/// god-object with the freedom of a pose. In each tick it goes, without friction, to where the springs'
/// energy is least among the poses that the bone leaves it. It moves by strides and looks where each would
/// end: what it meets there, as the planes of tip and shaft, limits the stride, and it looks again. It ends
/// outside bone, and does not stretch the springs but by what it takes to climb over the voxels' roughness.
/// Where the bone lets it leap, it goes at a limited speed beside the device's own (`move_bound`).
///
/// A line that begins in bone goes with the device, and is not held, until it is outside.
class HeldLine {
 public:
  /// The tip at the origin, the line along +z.
  void prepare(const Volume& volume, const ShaftSpan& span, const NormalRule& normal,
               const LineSprings& springs);
  void reset();
  /// Safe in the haptic tick.
  void follow(const Pose& X_WD, double dt_s);

  const Pose& X_WL() const { return X_WL_; }
  /// Held by bone, or on the way back to the device from it.
  bool is_held_back() const { return held_back_; }
  /// Bone pushes the tip, or has just given way under it.
  bool tip_rests() const { return tip_rests_; }
  /// The force of the bone on the shaft, and how far up it acts; none where the shaft is free.
  struct ShaftPush {
    Vec3 force_N;
    double lever_mm;
  };
  const std::optional<ShaftPush>& shaft_push() const { return shaft_push_; }

  /// The longest way that a point of the line goes between two looks at the bone.
  static constexpr double kStride_mm = 0.2;

 private:
  // A contact as it limits a move: along . translation + about . rotation >= -gap.
  struct Limit {
    Vec3 along;
    Vec3 about;
    double gap_mm;
    double response;
    // Of the tip, or how far up the shaft.
    bool is_tip;
    double lever_mm;
    double push = 0;
  };
  // With one look a line on a rim jumps off it, and in a turned scan is another.
  static constexpr int kLooks = 4;
  static constexpr std::size_t kLimits = (kLooks + 1) * (std::tuple_size_v<ShaftContacts> + 1);

  double travel_mm(const ToolMove& move) const;
  double reach_mm() const;
  bool add_tip_limit(const Pose& X_WL, const ToolMove& at);
  bool add_shaft_limits(const Pose& X_WL, const ToolMove& at);
  bool add_limit(const Vec3& out_W, double depth_mm, const ToolMove& at, bool is_tip, const Vec3& arm_W);
  ToolMove allowed(const ToolMove& wanted);
  ToolMove stride(const ToolMove& move) const;
  ToolMove look_along(const ToolMove& wanted);
  double energy_mm2(const Pose& X_WL, const Pose& X_WD) const;
  bool go(const ToolMove& move, const Pose& X_WD);
  void slide(const Pose& X_WD_before, const Pose& X_WD, double dt_s);
  void take_pushes();
  bool is_in_bone(const Pose& X_WL) const;

  const Volume* volume_ = nullptr;
  ShaftSpan span_{};
  NormalRule normal_;
  LineSprings springs_;
  // What a turn costs against a shift: mm^2.
  double turn_weight_mm2_ = 1;

  bool carried_ = true;
  bool held_back_ = false;
  double climbed_mm2_ = 0;
  Pose X_WL_;
  Pose X_WD_before_;
  std::array<Limit, kLimits> limits_;
  std::size_t limit_count_ = 0;
  bool tip_rests_ = false;
  Vec3 tip_normal_W_ = Vec3::Zero();
  std::optional<ShaftPush> shaft_push_;
};

}  // namespace osteomill::line_proxy
