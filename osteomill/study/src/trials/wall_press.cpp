#include "osteomill/study/wall_press.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace osteomill {

namespace {

constexpr double kMmPerM = 1000;
// Force that presses the handle.
constexpr double kPressForce_N = 0.5;
// Slow press, 5 mm/s at 1000 Hz, up to 3 mm beyond the first resistance: a wall that needs more counts as too
// soft.
constexpr double kDepthStep_mm = 0.005;
constexpr double kDeepest_mm = 3;
// Starts in free space: the start-up behaviour of an algorithm in contact is not part of the wall.
constexpr double kBeginsAbove_mm = 0.5;
constexpr int kSettleTicks = 50;
constexpr double kMinSwing_mm = 0.02;
constexpr double kMaxSwing_mm = 0.1;
constexpr double kDeadSwing_mm = 0.015;
constexpr double kAtRest_mm_s = 0.1;
constexpr double kGrowth = 4;
constexpr double kDecay = 0.99;
constexpr std::size_t kSwings = 36;
constexpr double kMax_s = 2;

// The wall as a function: depth in, force out.
class Wall {
 public:
  Wall(HapticAlgorithm& algorithm, double burr_radius_mm, const WallPress& press)
      : algorithm_(&algorithm), burr_radius_mm_(burr_radius_mm), press_(&press) {}

  Pose pose_at(double depth_mm) const {
    Pose X_WD;
    X_WD.position_mm.z() = burr_radius_mm_ - depth_mm;
    return X_WD;
  }
  double burr_radius_mm() const { return burr_radius_mm_; }
  double depth_of(const Pose& X_WD) const { return burr_radius_mm_ - X_WD.position_mm.z(); }
  // Returns the force along the wall's normal; not finite if the algorithm's is not.
  double force_N(const Pose& X_WD) { return algorithm_->step(X_WD, press_->tick_s).wrench.force_N.z(); }

 private:
  HapticAlgorithm* algorithm_;
  double burr_radius_mm_;
  const WallPress* press_;
};

// State in which the wall carries the pressing force, with the slope of its force there.
struct Equilibrium {
  double depth_mm;
  /// Depth beyond the wall's first resistance: an algorithm may feel the burr's centre and not its surface.
  double pressed_mm;
  double felt_N_per_mm;
};

std::optional<Equilibrium> press_slowly(Wall& wall) {
  double depth_mm = -kBeginsAbove_mm;
  double force_N = 0;
  double last_force_N = 0;
  double touch_mm = wall.burr_radius_mm();
  const auto press_to = [&](double wanted_N) {
    while (force_N < wanted_N && depth_mm < touch_mm + kDeepest_mm) {
      depth_mm += kDepthStep_mm;
      last_force_N = force_N;
      force_N = wall.force_N(wall.pose_at(depth_mm));
      if (force_N > 0) touch_mm = std::min(touch_mm, depth_mm - kDepthStep_mm);
    }
    return force_N >= wanted_N;
  };
  // Measures from the last depth below three quarters of the force, so that a jump in force gives a steep
  // slope, not a flat one.
  if (!press_to(0.75 * kPressForce_N)) return std::nullopt;
  const double shallow_mm = depth_mm - kDepthStep_mm;
  const double shallow_N = last_force_N;
  if (!press_to(kPressForce_N)) return std::nullopt;
  const double rest_mm = depth_mm;
  if (!press_to(1.25 * kPressForce_N)) return std::nullopt;
  const Equilibrium rest{rest_mm, std::max(rest_mm - touch_mm, kDepthStep_mm),
                         (force_N - shallow_N) / (depth_mm - shallow_mm)};
  while (depth_mm > rest_mm) wall.force_N(wall.pose_at(depth_mm -= kDepthStep_mm));
  for (int n = 0; n < kSettleTicks; ++n) wall.force_N(wall.pose_at(rest_mm));
  return rest;
}

// Distances between turning points of the handle's actual motion.
class Swings {
 public:
  explicit Swings(double depth_mm) : turned_at_mm_(depth_mm), last_mm_(depth_mm) {}

  void add_sample(double depth_mm) {
    const double move = depth_mm - last_mm_;
    if (move * direction_ < 0) {
      sizes_mm_.push_back(std::abs(last_mm_ - turned_at_mm_));
      turned_at_mm_ = last_mm_;
    }
    if (move != 0) direction_ = move;
    last_mm_ = depth_mm;
  }
  const std::vector<double>& sizes_mm() const { return sizes_mm_; }
  double max(std::size_t from, std::size_t to) const {
    double max = 0;
    for (std::size_t n = from; n < to; ++n) max = std::max(max, sizes_mm_[n]);
    return max;
  }

 private:
  double turned_at_mm_;
  double last_mm_;
  double direction_ = 0;
  std::vector<double> sizes_mm_;
};

// Returns whether the motion dies out, once this can be decided. The first swing is only half a swing.
std::optional<bool> decays(const Swings& swings) {
  const auto& sizes = swings.sizes_mm();
  if (sizes.size() < 3) return std::nullopt;
  if (std::max(sizes.back(), sizes[sizes.size() - 2]) < kDeadSwing_mm) return true;
  if (sizes.back() > kGrowth * sizes[1]) return false;
  return std::nullopt;
}

bool swing_dies_out(Wall& wall, const Equilibrium& rest, const WallPress& press) {
  SimulatedHandle handle(press.handle, wall.pose_at(rest.depth_mm));
  const double amplitude_mm = std::clamp(0.5 * rest.pressed_mm, kMinSwing_mm, kMaxSwing_mm);
  // Uses the mean stiffness over the whole depth; the slope may include a jump.
  const double stiffness_N_per_mm = kPressForce_N / rest.pressed_mm;
  const double speed_mm_s = amplitude_mm * std::sqrt(kMmPerM * stiffness_N_per_mm / press.handle.mass_kg);
  const double substep_s = press.handle.substep_s;
  const int substeps = static_cast<int>(std::lround(press.tick_s / substep_s));
  Swings swings(rest.depth_mm);
  // Applied for one substep, this force gives that speed.
  Wrench other;
  other.force_N.z() = -press.handle.mass_kg * speed_mm_s / (kMmPerM * substep_s);
  for (double time_s = 0; time_s < kMax_s && swings.sizes_mm().size() < kSwings; time_s += press.tick_s) {
    Wrench along;
    along.force_N.z() = wall.force_N(handle.read());
    if (!std::isfinite(along.force_N.z())) return false;
    handle.command(along);
    for (int n = 0; n < substeps; ++n) {
      handle.advance(other);
      swings.add_sample(wall.depth_of(handle.pose()));
      other.force_N.z() = -kPressForce_N - press.damping_Ns_per_mm * handle.velocity().linear_mm_s.z();
    }
    if (const auto known = decays(swings)) return *known;
  }
  const std::size_t count = swings.sizes_mm().size();
  // An overdamped handle creeps to rest without turning; one that breaks through does not come to rest.
  if (count < 6) return handle.velocity().linear_mm_s.norm() < kAtRest_mm_s;
  return swings.max(count - count / 3, count) <
         kDecay * swings.max(count - 2 * (count / 3), count - count / 3);
}

}  // namespace

WallPressResult press_on_wall(HapticAlgorithm& algorithm, double burr_radius_mm, const WallPress& press) {
  require_valid(press.handle);
  Wall wall(algorithm, burr_radius_mm, press);
  const std::optional<Equilibrium> rest = press_slowly(wall);
  if (!rest) return {};
  return {swing_dies_out(wall, *rest, press) ? WallMotion::decays : WallMotion::persists,
          rest->felt_N_per_mm};
}

double press_slowly_on_wall(HapticAlgorithm& algorithm, double burr_radius_mm, const WallPress& press) {
  Wall wall(algorithm, burr_radius_mm, press);
  const std::optional<Equilibrium> rest = press_slowly(wall);
  return rest ? rest->felt_N_per_mm : 0;
}

}  // namespace osteomill
