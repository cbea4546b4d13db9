#include "osteomill/haptics/line_proxy/shaft_touch.h"

#include <algorithm>
#include <cmath>

namespace osteomill::line_proxy {

namespace {

// The line is laid this much deeper than it is in balance, so that its contact is still found when it gets
// shallower.
constexpr double kMargin_voxels = 2.0;
constexpr double kMaxMargin_mm = 0.5;
constexpr double kMarginRate_mm_per_s = 10.0;
// A device that moves changes the reaction as a spring so many times as stiff as the tip's at most.
constexpr double kSlewStiffness = 2.0;
// A reaction that lags behind while it falls drives the hand away; it falls faster than it grows.
constexpr double kFasterFall = 4.0;

double shaft_stiffness(const ShaftContact& contact, const Vec3& axis_W, const ShaftTouchRule& rule) {
  const double arm_mm = contact.lever_mm * axis_W.cross(contact.out_W).norm();
  const double give_mm_per_N = arm_mm * arm_mm / rule.turning_Nmm_per_rad + 1.0 / rule.stiffest_N_per_mm;
  if (!(contact.lever_mm > 0.0)) return 0.0;
  // Nearer to the tip it gives way: alone it holds what it would further up times the lever's share of the
  // fade, squared.
  const double times = rule.fade_mm / contact.lever_mm;
  const double fading = std::max(0.0, times * times - 1.0);
  return 1.0 / (give_mm_per_N + fading / rule.tip_N_per_mm);
}

double moved_toward(double from, double to, double limit) {
  return from + std::clamp(to - from, -limit, limit);
}

Vec3 moved_toward(const Vec3& from, const Vec3& to, double limit) {
  const Vec3 way = to - from;
  const double distance = way.norm();
  return distance <= limit ? to : Vec3(from + limit / distance * way);
}

}  // namespace

void ShaftTouch::follow(const Volume& volume, const ShaftSpan& span, const LaidLine& line,
                        double first_lever_mm, const ShaftTouchRule& rule, double dt_s) {
  if (const auto found = find(volume, span, line, first_lever_mm, rule)) {
    go_to(*found, line, rule, dt_s);
  } else if (contact_) {
    let_go(rule, dt_s);
  }
}

std::optional<ShaftTouch::Found> ShaftTouch::find(const Volume& volume, const ShaftSpan& span,
                                                  const LaidLine& line, double first_lever_mm,
                                                  const ShaftTouchRule& rule) const {
  const Vec3 out_W = contact_ ? contact_->out_W : Vec3::Zero();
  const double near_mm = contact_ ? contact_->lever_mm : first_lever_mm;
  // Where the device has moved out by more than the margin, the push is undone bit by bit.
  const Vec3 pushed_mm = line.X_WL.position_mm - line.device_tip_W;
  const double full_margin_mm =
      std::min(kMaxMargin_mm, kMargin_voxels * volume.geometry().spacing_mm.minCoeff());
  const double margin_mm = contact_ ? contact_->margin_mm : 0.0;
  const int tries = contact_ && !line.rest ? 3 : 1;
  for (int n = 0; n < tries; ++n) {
    const Vec3 tip_W = line.X_WL.position_mm - 0.5 * n * pushed_mm - (n < 2 ? margin_mm : 0.0) * out_W;
    const auto contact = shaft_contact(volume, span, {tip_W, line.X_WL.orientation}, near_mm, out_W,
                                       rule.normal, full_margin_mm);
    if (contact) return Found{*contact, tip_W, full_margin_mm};
  }
  return std::nullopt;
}

void ShaftTouch::react(Contact& contact, double growth_N) {
  const double before_N = contact.reaction_N.norm();
  if (before_N > contact.push_N) contact.reaction_N *= contact.push_N / before_N;
  contact.reaction_N = moved_toward(contact.reaction_N, Vec3(contact.push_N * contact.out_W), growth_N);
}

void ShaftTouch::go_to(const Found& found, const LaidLine& line, const ShaftTouchRule& rule, double dt_s) {
  const Vec3 axis_W = shaft_direction(line.X_WL);
  const ShaftContact& contact = found.contact;
  if (!contact_)
    contact_ = Contact{contact.lever_mm,  contact.out_W, 0.0,         Vec3::Zero(), Vec3::Zero(), 0.0,
                       line.device_tip_W, axis_W,        Vec3::Zero()};
  // The push follows the contact at once in size but not in direction: in a notch narrower than the push is
  // long the two would chase each other.
  const Vec3 stayed_mm = contact_->shift_mm - (line.device_tip_W - contact_->device_tip_W);
  const Vec3 aside_mm =
      (1.0 - rule.turning_share) * (stayed_mm - stayed_mm.dot(contact.out_W) * contact.out_W);
  const double moved_mm =
      (line.device_tip_W - contact_->device_tip_W + contact.lever_mm * (axis_W - contact_->axis_W)).norm();
  contact_->device_tip_W = line.device_tip_W;
  contact_->axis_W = axis_W;
  const ShaftSprings springs{rule.tip_N_per_mm, shaft_stiffness(contact, axis_W, rule)};
  const double push_N =
      balanced_reaction_N(contact, found.line_tip_W, line.device_tip_W + aside_mm, line.rest, springs);
  const double growth_N = rule.slew_limit_N_per_s * dt_s + kSlewStiffness * rule.tip_N_per_mm * moved_mm;
  contact_->push_N =
      moved_toward(contact_->push_N, push_N, push_N < contact_->push_N ? kFasterFall * growth_N : growth_N);
  react(*contact_, growth_N);
  contact_->margin_mm = moved_toward(contact_->margin_mm, found.margin_mm, kMarginRate_mm_per_s * dt_s);
  contact_->lever_mm = moved_toward(contact_->lever_mm, contact.lever_mm, rule.slide_limit_mm_per_s * dt_s);
  contact_->out_W = contact.out_W;
  contact_->shift_mm = contact_->push_N / rule.tip_N_per_mm * contact_->out_W + aside_mm;
  contact_->point_W = found.line_tip_W + contact_->lever_mm * axis_W + contact.depth_mm * contact.out_W;
}

void ShaftTouch::let_go(const ShaftTouchRule& rule, double dt_s) {
  const double growth_N = rule.slew_limit_N_per_s * dt_s;
  contact_->push_N = moved_toward(contact_->push_N, 0.0, kFasterFall * growth_N);
  react(*contact_, growth_N);
  contact_->shift_mm = contact_->push_N / rule.tip_N_per_mm * contact_->out_W;
  if (contact_->push_N == 0.0) contact_.reset();
}

}  // namespace osteomill::line_proxy
