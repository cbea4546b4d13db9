#pragma once

#include <limits>
#include <optional>

#include "osteomill/base/pose.h"

namespace osteomill {

/// The knock of a fast tool that meets bone. Event-based transients, scaled by the speed of the impact, make
/// a virtual surface feel hard (Kuchenbecker, Fiene, Niemeyer 2006, doi 10.1109/TVCG.2006.32); these numbers
/// are this project's own.
struct ContactTransientSettings {
  bool on = false;
  /// Amplitude per speed of the impact, N s/mm, and the largest, N.
  double damping_N_s_per_mm = 0.005;
  double max_N = 0.5;
};

/// Opposes a tool's motion into bone by a decaying burst, 20 ms from a first contact. It is passive without
/// an account of energy: the force is a damping that rises and falls, so it takes energy from the hand while
/// the tool moves in and is zero while it moves out. Begins at zero and is continuous. Safe in the haptic
/// tick.
class ContactTransient {
 public:
  /// Slower impacts give none, nor do those sooner than this after the last contact. Otherwise a burr that
  /// jumps while it mills would knock without end.
  static constexpr double kMinSpeed_mm_s = 5, kMinFree_s = 0.03;

  explicit ContactTransient(const ContactTransientSettings& settings) : settings_(settings) {}

  /// Returns the force on the hand, in W, `dt_s` after the last call, for a device at `X_WD` on which the
  /// bone presses with `contact_W_N`.
  Vec3 force_N(const Pose& X_WD, const Vec3& contact_W_N, double dt_s) noexcept;
  /// Forgets the device's motion and the burst, as before the first tick.
  void reset() noexcept { *this = ContactTransient(settings_); }

 private:
  ContactTransientSettings settings_;
  std::optional<Vec3> last_W_mm_;
  Vec3 out_W_ = Vec3::UnitZ();
  double impact_mm_s_ = 0;
  double since_impact_s_ = std::numeric_limits<double>::infinity();
  double free_s_ = 0;
};

}  // namespace osteomill
