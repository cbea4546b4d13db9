#include "osteomill/haptics/surface_points/held_tool.h"

#include <algorithm>
#include <cmath>

namespace osteomill::surface_points {

namespace {

constexpr int kSweeps = 30;
// Lets contacts that contradict one another (a tool jammed between two walls) share the error.
constexpr double kSoftness = 1e-3;
constexpr double kSettled_mm = 1e-4;
// An overlap is undone by this much a stride: undone at once, a jammed tool would be thrown from wall to
// wall.
constexpr double kMaxRise_mm = 0.05;
// How often it looks where it would go, and the overlap there that is none.
constexpr int kLooks = 4;
constexpr double kUnseen_mm = 0.005;
// With bone in the way, more strides than this bring a jammed tool no nearer.
constexpr int kStridesInContact = 2;

}  // namespace

void HeldTool::prepare(const Volume& volume, const MillingTool& tool, int rings, double bite_mm) {
  contacts_.prepare(volume, tool, rings, bite_mm);
  limits_.reserve((1 + kLooks) * contacts_.capacity());
  length_mm_ = std::max(tool.burr_radius_mm, tool.shaft_length_mm);
  turn_weight_mm2_ = 0.25 * length_mm_ * length_mm_;
  placed_ = false;
}

double HeldTool::travel_mm(const Move& move) const {
  return move.shift_mm.norm() + move.turn_rad.norm() * length_mm_;
}

Pose HeldTool::after(const Move& move) const {
  return {X_WT_.position_mm + move.shift_mm,
          (quaternion_from_rotation_vector(move.turn_rad) * X_WT_.orientation).normalized()};
}

// What is seen from `X_WT`, the pose after the move `at`, as limits to a move from where the tool stands.
// True where the tool would overlap bone there.
bool HeldTool::add_limits(std::span<const RayContact> contacts, const Move& at, const Pose& X_WT) {
  bool overlaps = false;
  for (const RayContact& contact : contacts) {
    Limit limit;
    limit.along = contact.normal_W;
    limit.about = (contact.point_W - X_WT.position_mm).cross(contact.normal_W);
    overlaps = overlaps || contact.gap_mm < -kUnseen_mm;
    limit.gap_mm =
        std::max(contact.gap_mm - limit.along.dot(at.shift_mm) - limit.about.dot(at.turn_rad), -kMaxRise_mm);
    limit.response = 1 / (1 + limit.about.squaredNorm() / turn_weight_mm2_ + kSoftness);
    limits_.push_back(limit);
  }
  return overlaps;
}

// The allowed move nearest to `move`: projected Gauss-Seidel on the contacts' pushes. True where any of them
// pushes.
bool HeldTool::limit_move(Move& move) {
  bool pushed = false;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double change = 0;
    for (Limit& limit : limits_) {
      const double overlap = -limit.gap_mm - limit.along.dot(move.shift_mm) - limit.about.dot(move.turn_rad) -
                             kSoftness * limit.push;
      const double push = std::max(0.0, limit.push + limit.response * overlap);
      const double more = push - limit.push;
      if (more == 0) continue;
      limit.push = push;
      move.shift_mm += more * limit.along;
      move.turn_rad += more / turn_weight_mm2_ * limit.about;
      change = std::max(change, std::abs(more));
      pushed = true;
    }
    if (change < kSettled_mm) break;
  }
  return pushed;
}

// Looked for from where the tool stands, and where bone is near, where it would go: what only shows there is
// a limit too.
HeldTool::Move HeldTool::limited(const Move& wanted, bool& pushed) {
  limits_.clear();
  add_limits(contacts_.find(X_WT_), {}, X_WT_);
  Move move = wanted;
  pushed = limit_move(move);
  for (int look = 0; look < kLooks && !limits_.empty(); ++look) {
    const double share = std::min(1.0, kStride_mm / travel_mm(move));
    const Move ahead{share * move.shift_mm, share * move.turn_rad};
    const Pose X_WT = after(ahead);
    if (!add_limits(contacts_.find_again(X_WT, travel_mm(ahead)), ahead, X_WT)) break;
    for (Limit& limit : limits_) limit.push = 0;
    move = wanted;
    pushed = limit_move(move);
  }
  return move;
}

HeldTool::Stride HeldTool::stride(const Pose& X_WD) {
  bool pushed = false;
  const Move move = limited({X_WD.position_mm - X_WT_.position_mm,
                             rotation_vector(X_WD.orientation * X_WT_.orientation.conjugate())},
                            pushed);
  if (travel_mm(move) <= kStride_mm && !pushed) {
    X_WT_ = X_WD;
    return Stride::arrived;
  }
  const double share = std::min(1.0, kStride_mm / travel_mm(move));
  X_WT_ = after({share * move.shift_mm, share * move.turn_rad});
  if (share == 1) return Stride::arrived;
  return pushed ? Stride::pushed : Stride::free;
}

const Pose& HeldTool::follow(const Pose& X_WD) {
  if (!placed_) {
    X_WT_ = X_WD;
    placed_ = true;
  }
  int in_contact = 0;
  for (int n = 0; n < kStrides && in_contact < kStridesInContact; ++n) {
    const Stride did = stride(X_WD);
    if (did == Stride::arrived) break;
    if (did == Stride::pushed) ++in_contact;
  }
  return X_WT_;
}

}  // namespace osteomill::surface_points
