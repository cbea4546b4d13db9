#include "osteomill/haptics/line_proxy/held_line.h"

#include <algorithm>
#include <cmath>

#include "osteomill/haptics/line_proxy/bone_march.h"
#include "osteomill/volume/isosurface.h"

namespace osteomill::line_proxy {

namespace {

// So many strides a tick at most.
constexpr int kStrides = 8;
constexpr int kSweeps = 100;
constexpr double kSettled_mm = 1e-6;
// Lets contacts that contradict one another (a line jammed between two walls) share the error.
constexpr double kSoftness = 1e-4;
// The line is kept so far off the bone, and a move that would still end in it is halved so often at most.
constexpr double kSkin_mm = 1e-3;
constexpr int kHalvings = 6;
// Contacts are told apart, and means taken, within so much of their depth.
constexpr double kSoftContact_voxels = 2.0;
constexpr double kMaxSoftContact_mm = 0.5;

// From a point in bone out along a direction to the isosurface.
std::optional<Vec3> way_out_along(const Volume& volume, const Vec3& point_W, const Vec3& out_W,
                                  double reach_mm) {
  const double step_mm = 0.25 * volume.geometry().spacing_mm.minCoeff();
  Vec3 inside_W = point_W;
  for (double way_mm = step_mm; way_mm < reach_mm + step_mm; way_mm += step_mm) {
    const Vec3 here_W = point_W + way_mm * out_W;
    if (!in_bone(volume, here_W)) return bisect_crossing(volume, here_W, inside_W);
    inside_W = here_W;
  }
  return std::nullopt;
}

// Where the bone lets the line leap, it goes beyond the device's own movement at these speeds.
constexpr double kLeap_mm_s = 30;
constexpr double kLeap_rad_s = 0.05;
// Of the turn by which a move of the device would be made at the far end.
constexpr double kTurnByMove = 0.25;
// How much of the way to where the energy is least is gone at once: with all of it, a line between two walls
// would be thrown from one to the other.
constexpr double kRelaxation = 0.5;
constexpr double kLeast = 1e-12;
constexpr double kGivenWay_mm = 0.1;
// A slow machine's tick counts as this long.
constexpr double kMaxTick_s = 5e-3;

ToolMove operator+(const ToolMove& a, const ToolMove& b) {
  return {a.translation_mm + b.translation_mm, a.rotation_rad + b.rotation_rad};
}
ToolMove operator*(double share, const ToolMove& move) {
  return {share * move.translation_mm, share * move.rotation_rad};
}
ToolMove operator-(const ToolMove& a, const ToolMove& b) {
  return a + -1.0 * b;
}

bool is_at(const Pose& a, const Pose& b) {
  return a.position_mm == b.position_mm && a.orientation.coeffs() == b.orientation.coeffs();
}

}  // namespace

void HeldLine::prepare(const Volume& volume, const ShaftSpan& span, const NormalRule& normal,
                       const LineSprings& springs) {
  volume_ = &volume;
  span_ = span;
  normal_ = normal;
  springs_ = springs;
  turn_weight_mm2_ = springs.turning_Nmm_per_rad / springs.tip_N_per_mm;
  reset();
}

void HeldLine::reset() {
  placed_ = false;
  carried_ = false;
  held_back_ = false;
  limit_count_ = 0;
  tip_rests_ = false;
  shaft_push_.reset();
}

bool HeldLine::is_in_bone(const Pose& X_WL) const {
  if (in_bone(*volume_, X_WL.position_mm)) return true;
  const Vec3 along_W = shaft_direction(X_WL);
  const int samples = static_cast<int>((span_.end_mm - span_.start_mm) / span_.sample_mm + 0.5);
  for (int n = 0; n <= samples; ++n) {
    if (in_bone(*volume_, X_WL.position_mm + (span_.start_mm + n * span_.sample_mm) * along_W)) return true;
  }
  return false;
}

double HeldLine::travel_mm(const ToolMove& move) const {
  return move.translation_mm.norm() + move.rotation_rad.norm() * span_.end_mm;
}

// False where there is no room for more. The line stands outside, so that staying is always allowed.
bool HeldLine::add_limit(const Vec3& out_W, const Vec3& about_W, double depth_mm, const ToolMove& at,
                         bool is_tip, double lever_mm) {
  if (limit_count_ == limits_.size()) return false;
  const double gap_mm =
      std::max(0.0, -(depth_mm + kSkin_mm + out_W.dot(at.translation_mm) + about_W.dot(at.rotation_rad)));
  const double response = 1 / (1 + about_W.squaredNorm() / turn_weight_mm2_ + kSoftness);
  limits_[limit_count_++] = {out_W, about_W, gap_mm, response, is_tip, lever_mm};
  return true;
}

// `X_WL` is where the line would be after the move `at`.
bool HeldLine::add_tip_limit(const Pose& X_WL, const ToolMove& at) {
  const Volume& volume = *volume_;
  const Vec3& from_W = X_WL_.position_mm;
  const Vec3& to_W = X_WL.position_mm;
  const bool begins_in_bone = in_bone(volume, from_W);
  const std::optional<Vec3> met_W = begins_in_bone ? std::nullopt : first_crossing(volume, from_W, to_W);
  if (!met_W && !in_bone(volume, to_W)) return false;
  const Vec3 back_W = (from_W - to_W).normalized();
  const Vec3 normal_W = surface_normal(volume, met_W.value_or(to_W), normal_).value_or(back_W);
  const double reach_mm = kStride_mm + 2 * volume.geometry().spacing_mm.maxCoeff();
  const Vec3 surface_W =
      in_bone(volume, to_W) ? way_out_along(volume, to_W, normal_W, reach_mm).value_or(met_W.value_or(from_W))
                            : *met_W;
  const Vec3 out_W = surface_normal(volume, surface_W, normal_).value_or(normal_W);
  return add_limit(out_W, Vec3::Zero(), out_W.dot(surface_W - to_W), at, true, 0);
}

bool HeldLine::add_shaft_limits(const Pose& X_WL, const ToolMove& at) {
  const double soft_mm =
      std::min(kMaxSoftContact_mm, kSoftContact_voxels * volume_->geometry().spacing_mm.minCoeff());
  const ShaftContacts contacts = shaft_contacts(*volume_, span_, X_WL, X_WL_, normal_, soft_mm);
  const Vec3 axis_W = shaft_direction(X_WL);
  bool overlaps = false;
  for (std::size_t n = 0; n < contacts.count; ++n) {
    const ShaftContact& contact = contacts.all[n];
    const Vec3 about_W = (contact.lever_mm * axis_W).cross(contact.out_W);
    overlaps = add_limit(contact.out_W, about_W, contact.depth_mm, at, false, contact.lever_mm) || overlaps;
  }
  return overlaps;
}

// The move of least energy that the limits allow: projected Gauss-Seidel on their pushes. True where any
// pushes.
bool HeldLine::solve(ToolMove& move) {
  for (std::size_t n = 0; n < limit_count_; ++n) limits_[n].push = 0;
  bool pushed = false;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double change = 0;
    for (std::size_t n = 0; n < limit_count_; ++n) {
      Limit& limit = limits_[n];
      const double overlap = -limit.gap_mm - limit.along.dot(move.translation_mm) -
                             limit.about.dot(move.rotation_rad) - kSoftness * limit.push;
      const double push = std::max(0.0, limit.push + limit.response * overlap);
      const double more = push - limit.push;
      if (more == 0) continue;
      limit.push = push;
      move.translation_mm += more * limit.along;
      move.rotation_rad += more / turn_weight_mm2_ * limit.about;
      change = std::max(change, std::abs(more));
      pushed = true;
    }
    if (change < kSettled_mm) break;
  }
  return pushed;
}

// As much of a move as a stride may be.
double HeldLine::stride_share(const ToolMove& move) const {
  return kStride_mm / std::max(kStride_mm, travel_mm(move));
}

// The move nearest to the one that is wanted that the bone allows, as far as it shows from where the line
// stands and from where a stride would take it.
ToolMove HeldLine::allowed(const ToolMove& wanted, bool& pushed) {
  ToolMove move = wanted;
  limit_count_ = 0;
  pushed = false;
  for (int look = 0; look <= kLooks; ++look) {
    const ToolMove near = stride_share(move) * move;
    const Pose X_WL = moved(X_WL_, near);
    const bool tip = add_tip_limit(X_WL, near);
    const bool shaft = add_shaft_limits(X_WL, near);
    if (!tip && !shaft) break;
    move = wanted;
    pushed = solve(move);
  }
  return move;
}

// At most a stride of a move, and as much of it as ends outside bone.
void HeldLine::go(const ToolMove& move) {
  double share = stride_share(move);
  for (int n = 0; n <= kHalvings; ++n, share /= 2) {
    const Pose X_WL = moved(X_WL_, share * move);
    if (is_in_bone(X_WL)) continue;
    X_WL_ = X_WL;
    return;
  }
}

// Straight to the device, where bone did not hold the line before.
void HeldLine::fly(const Pose& X_WD) {
  bool pushed = false;
  const ToolMove move = allowed(move_between(X_WL_, X_WD), pushed);
  take_pushes();
  if (!pushed && stride_share(move) == 1) {
    X_WL_ = X_WD;
  } else {
    go(move);
  }
}

// With the device as it moves, and on towards where the springs' energy is least.
void HeldLine::slide(const ToolMove& device, const Pose& X_WD, const Leap& most) {
  const ToolMove whole = move_between(X_WL_, X_WD);
  bool pushed = false;
  ToolMove move = allowed(device + kRelaxation * (whole - device), pushed);
  take_pushes();
  if (!pushed && most.allows(whole - device) == 1 && !is_in_bone(X_WD)) {
    X_WL_ = X_WD;
    return;
  }
  if (const double share = most.allows(move - device); share < 1) {
    const ToolMove with_device = allowed(device, pushed);
    move = with_device + share * (move - with_device);
    // Where going along with the device is itself a leap, the turn, and with it the torque, comes over a few
    // ticks.
    const Vec3 turned = move.rotation_rad - device.rotation_rad;
    move.rotation_rad = device.rotation_rad + most.turn_rad / std::max(most.turn_rad, turned.norm()) * turned;
  }
  go(move);
}

void HeldLine::take_pushes() {
  double push = 0;
  double tip_push = 0;
  double moment = 0;
  Vec3 force = Vec3::Zero();
  for (std::size_t n = 0; n < limit_count_; ++n) {
    const Limit& limit = limits_[n];
    if (limit.is_tip) {
      if (limit.push > tip_push) tip_normal_W_ = limit.along;
      tip_push = std::max(tip_push, limit.push);
      continue;
    }
    push += limit.push;
    moment += limit.push * limit.lever_mm;
    force += limit.push * limit.along;
  }
  // Bone that milling takes from under a tip is followed down, not lost.
  const Vec3 below_W = X_WL_.position_mm - kGivenWay_mm * tip_normal_W_;
  tip_rests_ = tip_push > 0 || (tip_rests_ && in_bone(*volume_, below_W));
  shaft_push_.reset();
  if (push > 0) shaft_push_ = ShaftPush{springs_.tip_N_per_mm * force, moment / push};
}

double HeldLine::Leap::allows(const ToolMove& leap) const {
  return std::min(move_mm / std::max(move_mm, leap.translation_mm.norm()),
                  turn_rad / std::max(turn_rad, leap.rotation_rad.norm()));
}

void HeldLine::follow(const Pose& X_WD, double dt_s) {
  if (!placed_) X_WL_ = X_WD_before_ = X_WD;
  if (!placed_ || carried_) {
    X_WL_ = X_WD;
    carried_ = is_in_bone(X_WL_);
    placed_ = true;
  }
  if (!carried_) {
    const ToolMove device = move_between(X_WD_before_, X_WD);
    const double way_mm = travel_mm(held_back_ ? device : move_between(X_WL_, X_WD));
    const int strides = std::clamp(static_cast<int>(std::ceil(way_mm / kStride_mm)), 1, kStrides);
    const double part = 1.0 / strides;
    const double tick_s = std::clamp(dt_s, 0.0, kMaxTick_s);
    // As much as the device moves may be gone the other way: a line that went along with a device that draws
    // back would give the hand more than it put in.
    const double device_mm = device.translation_mm.norm();
    const Leap most{
        part * (device_mm + kLeap_mm_s * tick_s) + kLeast,
        part * (device.rotation_rad.norm() + kTurnByMove * device_mm / span_.end_mm + kLeap_rad_s * tick_s) +
            kLeast};
    for (int n = 1; n <= strides; ++n) {
      if (held_back_) {
        slide(part * device, moved(X_WD, -(1 - n * part) * device), most);
      } else {
        fly(X_WD);
      }
      if (is_at(X_WL_, X_WD)) break;
    }
    held_back_ = tip_rests_ || shaft_push_ || (held_back_ && !is_at(X_WL_, X_WD));
  }
  X_WD_before_ = X_WD;
}

}  // namespace osteomill::line_proxy
