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
// With bone in the way, more strides than this bring a jammed tool no nearer.
constexpr int kStridesInContact = 2;

}  // namespace

void HeldTool::prepare(const Volume& volume, const MillingTool& tool, int rings, double bite_mm) {
  contacts_.prepare(volume, tool, rings, bite_mm);
  limits_.reserve(contacts_.capacity());
  length_mm_ = std::max(tool.burr_radius_mm, tool.shaft_length_mm);
  turn_weight_mm2_ = 0.25 * length_mm_ * length_mm_;
  placed_ = false;
}

void HeldTool::set_limits() {
  limits_.clear();
  for (const RayContact& contact : contacts_.find(X_WT_)) {
    Limit limit;
    limit.along = contact.normal_W;
    limit.about = (contact.point_W - X_WT_.position_mm).cross(contact.normal_W);
    limit.gap_mm = std::max(contact.gap_mm, -kMaxRise_mm);
    limit.response = 1 / (1 + limit.about.squaredNorm() / turn_weight_mm2_ + kSoftness);
    limits_.push_back(limit);
  }
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

HeldTool::Stride HeldTool::stride(const Pose& X_WD) {
  set_limits();
  Move move{X_WD.position_mm - X_WT_.position_mm,
            rotation_vector(X_WD.orientation * X_WT_.orientation.conjugate())};
  const bool pushed = limit_move(move);
  const double travel_mm = move.shift_mm.norm() + move.turn_rad.norm() * length_mm_;
  if (travel_mm <= kStride_mm && !pushed) {
    X_WT_ = X_WD;
    return Stride::arrived;
  }
  const double share = std::min(1.0, kStride_mm / travel_mm);
  X_WT_.position_mm += share * move.shift_mm;
  X_WT_.orientation =
      (quaternion_from_rotation_vector(share * move.turn_rad) * X_WT_.orientation).normalized();
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
