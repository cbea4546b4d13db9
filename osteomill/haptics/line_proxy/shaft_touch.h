#pragma once

#include <optional>

#include "osteomill/haptics/line_proxy/shaft_balance.h"
#include "osteomill/haptics/line_proxy/shaft_contact.h"

namespace osteomill::line_proxy {

/// How a touching shaft answers. Limits are per second, and may be infinite.
struct ShaftTouchRule {
  NormalRule normal;
  /// The spring of eq. 6, against which the shaft pushes the tool's tip.
  double tip_N_per_mm;
  /// The spring that holds the tool's orientation to the device's, ...
  double turning_Nmm_per_rad;
  /// ... and what the reaction grows with where the shaft cannot turn away.
  double stiffest_N_per_mm;
  /// The reaction grows from nothing at the tip, with the square of the lever, to full at this one; 0 for
  /// none.
  double fade_mm;
  /// How much of the way the push turns at once to where the contact points, in (0, 1].
  double turning_share;
  double slide_limit_mm_per_s;
  double slew_limit_N_per_s;
};

/// Where the tool is laid against the device.
struct LaidLine {
  /// The device's orientation at the tool's tip.
  Pose X_WL;
  Vec3 device_tip_W;
  /// Where the tool's tip rests on bone, if it does.
  std::optional<TipRest> rest;
};

/// The contact of the shaft from tick to tick: how far up the shaft, which way out, and with what force.
class ShaftTouch {
 public:
  /// Begins, goes on or ends. `first_lever_mm` names the contact where there are several and none yet. Safe
  /// in the haptic tick.
  void follow(const Volume& volume, const ShaftSpan& span, const LaidLine& line, double first_lever_mm,
              const ShaftTouchRule& rule, double dt_s);
  void reset() { contact_.reset(); }

  bool touches() const { return contact_.has_value(); }
  /// On the tool, in W; zero where nothing touches.
  Vec3 reaction_N() const { return contact_ ? contact_->reaction_N : Vec3::Zero(); }
  /// How far it pushes the tool's tip from the device's, in W; zero where nothing touches.
  Vec3 shift_mm() const { return contact_ ? contact_->shift_mm : Vec3::Zero(); }
  /// Where nothing touches these have no meaning.
  double lever_mm() const { return contact_->lever_mm; }
  const Vec3& out_W() const { return contact_->out_W; }
  /// On the surface of the bone.
  const Vec3& point_W() const { return contact_->point_W; }

 private:
  struct Contact {
    double lever_mm;
    Vec3 out_W;
    double push_N;
    // Never more than push_N, and turns to out_W no faster than it may grow: where the bone's normal flickers
    // from tick to tick, the torque must not.
    Vec3 reaction_N;
    Vec3 shift_mm;
    double margin_mm;
    // The device, to tell how far it has moved since.
    Vec3 device_tip_W;
    Vec3 axis_W;
    Vec3 point_W;
  };
  struct Found {
    ShaftContact contact;
    Vec3 line_tip_W;
    double margin_mm;
  };
  std::optional<Found> find(const Volume& volume, const ShaftSpan& span, const LaidLine& line,
                            double first_lever_mm, const ShaftTouchRule& rule) const;
  void go_to(const Found& found, const LaidLine& line, const ShaftTouchRule& rule, double dt_s);
  static void react(Contact& contact, double growth_N);
  void let_go(const ShaftTouchRule& rule, double dt_s);

  std::optional<Contact> contact_;
};

}  // namespace osteomill::line_proxy
