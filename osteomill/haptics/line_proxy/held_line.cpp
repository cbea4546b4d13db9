#include "osteomill/haptics/line_proxy/held_line.h"

#include <algorithm>
#include <cmath>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

// So many strides a tick at most. With one a tool that is dropped on bone is thrown back.
constexpr int kStrides = 8;
constexpr int kSweeps = 100;
constexpr double kSettled_mm = 1e-6;
// Lets contacts that contradict one another (a line jammed between two walls) share the error.
constexpr double kSoftness = 1e-5;
// kSkin_mm: how far the line is kept off the bone; without it the steps of torque in the tooth may be four
// times as large. kHalvings: how often at most a move that would still end in bone is halved; without it
// those steps may be twice as large.
constexpr double kSkin_mm = 2e-5;
constexpr int kHalvings = 6;
// How steeply a stride may climb on what it meets: without that the force of a thin tool steps by half as
// much again, as where milling breaks through.
constexpr double kMaxSlope = 0.25;
// What two looks along the line may miss between them: without that a line on a rim sticks for a tick or two,
// in a turned scan and not in the straight one.
constexpr double kBetweenLooks_mm = 0.01;
// How far, in voxels, a line may climb in all against its springs before it has to come down again. The
// tests that begin HeldLine.InARoughHole say why.
constexpr double kRoughness_voxels = 0.15;
// As deep as a stride can have taken a point, and as far as its way out may be longer for that.
constexpr double kReachBeyond_voxels = 2;
// How much of the way to where the energy is least is gone at once. With all of it the force steps by more
// than twice as much on a ball with an edge of one voxel.
constexpr double kRelaxation = 0.5;
// So deep below it bone still carries a tip: without that a tool rebounds with nearly twice the energy.
constexpr double kGivenWay_mm = 0.1;

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
  carried_ = true;
  held_back_ = false;
  climbed_mm2_ = 0;
  limit_count_ = 0;
  tip_rests_ = false;
  shaft_push_.reset();
}

bool HeldLine::is_in_bone(const Pose& X_WL) const {
  return is_bone_at(*volume_, X_WL.position_mm) || shaft_in_bone(*volume_, span_, X_WL);
}

double HeldLine::travel_mm(const ToolMove& move) const {
  return move.translation_mm.norm() + move.rotation_rad.norm() * span_.end_mm;
}

// The line stands outside the bone, so it cannot have gone in deeper than it went: what says so leads the
// wrong way out and is left out, and the answer is false.
bool HeldLine::add_limit(const Vec3& out_W, double depth_mm, const ToolMove& at, bool is_tip,
                         const Vec3& arm_W) {
  const Vec3 way_W = at.translation_mm + at.rotation_rad.cross(arm_W);
  const double climb_mm = depth_mm + kSkin_mm + out_W.dot(way_W);
  if (climb_mm > kBetweenLooks_mm + kMaxSlope * way_W.norm()) return false;
  const Vec3 about_W = arm_W.cross(out_W);
  const double response = 1 / (1 + about_W.squaredNorm() / turn_weight_mm2_ + kSoftness);
  limits_[limit_count_++] = {out_W, about_W, -climb_mm, response, is_tip, arm_W.norm()};
  return true;
}

// `X_WL` is where the line would be after the move `at`.
bool HeldLine::add_tip_limit(const Pose& X_WL, const ToolMove& at) {
  const Vec3& from_W = X_WL_.position_mm;
  const Vec3& to_W = X_WL.position_mm;
  const auto met_W = first_crossing(*volume_, from_W, to_W);
  if (!met_W) return false;
  const Vec3 normal_W = surface_normal(*volume_, *met_W, normal_).value_or((from_W - to_W).normalized());
  // At the end of the way: with the plane where the tip met the bone it sticks, as on a ball.
  const auto depth_mm =
      is_bone_at(*volume_, to_W) ? depth_along(*volume_, to_W, normal_W, reach_mm()) : std::nullopt;
  const Vec3 surface_W = depth_mm ? Vec3(to_W + *depth_mm * normal_W) : *met_W;
  // With the normal of where the tip met it the force steps by half as much again on the way round a ball.
  const Vec3 out_W = surface_normal(*volume_, surface_W, normal_).value_or(normal_W);
  return add_limit(out_W, out_W.dot(surface_W - to_W), at, true, Vec3::Zero());
}

double HeldLine::reach_mm() const {
  return kStride_mm + kReachBeyond_voxels * volume_->geometry().spacing_mm.maxCoeff();
}

bool HeldLine::add_shaft_limits(const Pose& X_WL, const ToolMove& at) {
  const auto contacts = shaft_contacts(*volume_, span_, X_WL, normal_, reach_mm());
  if (!contacts) return false;
  const Vec3 axis_W = shaft_direction(X_WL);
  bool overlaps = false;
  for (const ShaftContact& contact : *contacts)
    overlaps = add_limit(contact.out_W, contact.depth_mm, at, false, contact.lever_mm * axis_W) || overlaps;
  return overlaps;
}

// The move nearest to the one that is wanted that the limits allow: projected Gauss-Seidel on their pushes.
ToolMove HeldLine::allowed(const ToolMove& wanted) {
  ToolMove move = wanted;
  for (std::size_t n = 0; n < limit_count_; ++n) limits_[n].push = 0;
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
    }
    if (change < kSettled_mm) break;
  }
  return move;
}

// As much of a move as a stride may be.
ToolMove HeldLine::stride(const ToolMove& move) const {
  return kStride_mm / std::max(kStride_mm, travel_mm(move)) * move;
}

// What bone leaves of a move, as far as it shows from where a stride would take the line.
ToolMove HeldLine::look_along(const ToolMove& wanted) {
  limit_count_ = 0;
  ToolMove move = wanted;
  for (int look = 0; look <= kLooks; ++look) {
    const ToolMove near = stride(move);
    const Pose X_WL = moved(X_WL_, near);
    const bool tip = add_tip_limit(X_WL, near);
    const bool shaft = add_shaft_limits(X_WL, near);
    if (!tip && !shaft) break;
    move = allowed(wanted);
  }
  take_pushes();
  return move;
}

// What the springs hold, per their stiffness at the tip.
double HeldLine::energy_mm2(const Pose& X_WL, const Pose& X_WD) const {
  const ToolMove stretch = move_between(X_WL, X_WD);
  return stretch.translation_mm.squaredNorm() + turn_weight_mm2_ * stretch.rotation_rad.squaredNorm();
}

// False, and the line stays, where the move ends in bone, or would stretch the springs by more than it takes
// to climb over the bone's roughness: what is climbed has to be come down again before more is.
bool HeldLine::go(const ToolMove& move, const Pose& X_WD) {
  const Pose X_WL = moved(X_WL_, move);
  const double energy_before_mm2 = energy_mm2(X_WL_, X_WD);
  const double climbed_mm2 = climbed_mm2_ + energy_mm2(X_WL, X_WD) - energy_before_mm2;
  const double roughness_mm = kRoughness_voxels * volume_->geometry().spacing_mm.minCoeff();
  if (climbed_mm2 > 2 * roughness_mm * std::sqrt(energy_before_mm2) || is_in_bone(X_WL)) return false;
  climbed_mm2_ = std::max(0.0, climbed_mm2);
  X_WL_ = X_WL;
  return true;
}

// With the device as it moves, and on towards where the springs' energy is least.
void HeldLine::slide(const Pose& X_WD_before, const Pose& X_WD, double dt_s) {
  const ToolMove device = move_between(X_WD_before, X_WD), whole = move_between(X_WL_, X_WD);
  const MoveBound bound = move_bound(X_WL_, X_WD_before, X_WD, std::sqrt(turn_weight_mm2_), Release{}, dt_s);
  // A line that is not held goes to the device as it may.
  const auto share = [&](const ToolMove& move) { return held_back_ ? share_within(bound, move) : 1; };
  const ToolMove left =
      look_along({device.translation_mm + kRelaxation * (whole.translation_mm - device.translation_mm),
                  device.rotation_rad + kRelaxation * (whole.rotation_rad - device.rotation_rad)});
  if (limit_count_ == 0 && travel_mm(whole) <= kStride_mm && share(whole) == 1 && !is_in_bone(X_WD)) {
    X_WL_ = X_WD;
    return;
  }
  ToolMove move = stride(left);
  move = share(move) * move;
  for (int n = 0; n <= kHalvings && !go(move, X_WD); ++n) move = 0.5 * move;
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
  tip_rests_ = tip_push > 0 || (tip_rests_ && is_bone_at(*volume_, below_W));
  shaft_push_.reset();
  if (push > 0) shaft_push_ = ShaftPush{springs_.tip_N_per_mm / kRelaxation * force, moment / push};
}

void HeldLine::follow(const Pose& X_WD, double dt_s) {
  if (carried_) {
    X_WL_ = X_WD;
    carried_ = is_in_bone(X_WD);
  } else {
    const ToolMove device = move_between(X_WD_before_, X_WD);
    const double way_mm = travel_mm(held_back_ ? device : move_between(X_WL_, X_WD));
    const int strides = std::clamp(static_cast<int>(std::ceil(way_mm / kStride_mm)), 1, kStrides);
    const double part = 1.0 / strides;
    Pose before = X_WD_before_;
    for (int n = 1; n <= strides && X_WL_ != X_WD; ++n) {
      const Pose next = n == strides ? X_WD : moved(X_WD_before_, n * part * device);
      slide(before, next, part * dt_s);
      before = next;
    }
    held_back_ = tip_rests_ || shaft_push_ || (held_back_ && X_WL_ != X_WD);
  }
  X_WD_before_ = X_WD;
}

}  // namespace osteomill::line_proxy
