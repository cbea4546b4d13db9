#pragma once

#include <limits>
#include <optional>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Settings of the knock felt when a fast tool hits bone. Event-based transients scaled by the impact speed
/// make a virtual surface feel hard (Kuchenbecker, Fiene, Niemeyer 2006, doi 10.1109/TVCG.2006.32); the
/// values are this project's own.
struct ContactTransientSettings {
  bool on = false;
  /// Amplitude per impact speed, N s/mm, and its maximum, N.
  double damping_N_s_per_mm = 0.005;
  double max_N = 0.5;
};

/// Opposes a tool's motion into bone by a decaying burst that lasts 20 ms from first contact. Passive by
/// construction: the force is a time-varying damping that only takes energy while the tool moves in and is
/// zero while it moves out. Starts at zero and is continuous. Safe in the haptic tick.
class ContactTransient {
 public:
  /// Minimum impact speed, and minimum time without contact before an impact. Otherwise a burr that bounces
  /// while milling would knock continuously.
  static constexpr double kMinSpeed_mm_s = 5, kMinFree_s = 0.03;

  explicit ContactTransient(const ContactTransientSettings& settings) : settings_(settings) {}

  /// Returns the force on the hand, in W, `dt_s` after the last call, for a device at `X_WD` with the contact
  /// force `contact_W_N` on the hand.
  Vec3 force_N(const Pose& X_WD, const Vec3& contact_W_N, double dt_s) noexcept;
  /// Resets to the state before the first tick.
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
