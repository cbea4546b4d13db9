#include <algorithm>

#include <fmt/core.h>

#include "verification/probing.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

using namespace testing_support;

constexpr double kSpeed_mm_s = 20;
constexpr double kDeep_mm = 0.5;
constexpr int kScenes = 12;
constexpr int kPresses = 20;
// Distance along the shaft at which it meets the edge, mm.
constexpr double kLever_mm = 10;

Vec3 turn_between(const Pose& from, const Pose& to) {
  return rotation_vector(to.orientation * from.orientation.conjugate());
}

// Sums the energy that passes through the device: a wrench is held for a tick, in which the device moves.
struct PassivityObserver {
  double supplied_Nmm = 0;
  double returned_Nmm = 0;

  void record(const Wrench& wrench, const Pose& X_WD, const Pose& X_WD_next) {
    const double to_the_hand_Nmm = wrench.force_N.dot(X_WD_next.position_mm - X_WD.position_mm) +
                                   wrench.torque_Nmm.dot(turn_between(X_WD, X_WD_next));
    (to_the_hand_Nmm > 0 ? returned_Nmm : supplied_Nmm) += std::abs(to_the_hand_Nmm);
  }
  double share() const { return returned_Nmm / supplied_Nmm; }
};

// Moves the device to a pose at kSpeed_mm_s, measured at the burr or as rotation at the shaft's lever,
// whichever is longer.
void move_device(HapticAlgorithm& algorithm, Pose& X_WD, const Pose& X_WD_to, PassivityObserver& observer) {
  const Vec3 way_mm = X_WD_to.position_mm - X_WD.position_mm;
  const Vec3 turn_rad = turn_between(X_WD, X_WD_to);
  const double length_mm = std::max(way_mm.norm(), turn_rad.norm() * kLever_mm);
  const int ticks = std::max(1, static_cast<int>(length_mm / (kSpeed_mm_s * kTick_s)));
  const Pose X_WD_from = X_WD;
  for (int n = 1; n <= ticks; ++n) {
    const double share = static_cast<double>(n) / ticks;
    const Pose X_WD_next{
        X_WD_from.position_mm + share * way_mm,
        (quaternion_from_rotation_vector(share * turn_rad) * X_WD_from.orientation).normalized()};
    observer.record(algorithm.step(X_WD, kTick_s).wrench, X_WD, X_WD_next);
    X_WD = X_WD_next;
  }
}

double contact_radius_mm(std::string_view algorithm, double radius_mm) {
  return algorithm == "line-proxy" ? 0 : radius_mm;
}

std::unique_ptr<HapticAlgorithm> prepared_default(std::string_view algorithm, const Volume& bone) {
  return prepared(algorithm, bone, MillingTool{}, algorithm == "surface-points" ? 20 : 2);
}

// Presses the tool in and draws it back along one line. Returns energy returned / put in.
double press_and_retract(std::string_view algorithm, const Volume& bone, const Pose& X_W_touching,
                         const Vec3& out) {
  const auto felt = prepared_default(algorithm, bone);
  Pose X_WD{X_W_touching.position_mm + 1.0 * out, X_W_touching.orientation};
  const Pose X_W_free = X_WD;
  PassivityObserver observer;
  move_device(*felt, X_WD, {X_W_touching.position_mm - kDeep_mm * out, X_W_touching.orientation}, observer);
  move_device(*felt, X_WD, X_W_free, observer);
  return observer.share();
}

double press_burr_on_plane(std::string_view algorithm, SeededRandom& random) {
  const Vec3 out = random_direction(random);
  const Volume bone = shape_volume(centred_cube(60, 0.2), plane(Vec3::Zero(), out));
  return press_and_retract(algorithm, bone,
                           {contact_radius_mm(algorithm, MillingTool{}.burr_radius_mm) * out,
                            smallest_rotation(Vec3::UnitZ(), out)},
                           out);
}

double press_shaft_on_edge(std::string_view algorithm, SeededRandom& random) {
  const Quat turn = random_orientation(random);
  const Vec3 left = turn * Vec3(1, 0, 1).normalized();
  const Vec3 right = turn * Vec3(-1, 0, 1).normalized();
  const Volume bone =
      shape_volume(centred_cube(64, 0.2), [&](const Vec3& p) { return std::max(left.dot(p), right.dot(p)); });
  const double radius_mm = contact_radius_mm(algorithm, MillingTool{}.shaft_radius_mm);
  return press_and_retract(algorithm, bone,
                           {turn * Vec3(-kLever_mm, 0, radius_mm),
                            turn * quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0})},
                           turn * Vec3::UnitZ());
}

// Presses and leans the tool at random in a hole, so that burr and shaft, or two walls, touch at once.
double press_in_hole(std::string_view algorithm, SeededRandom& random) {
  const Vec3 axis = random_direction(random);
  const double radius_mm = contact_radius_mm(algorithm, MillingTool{}.burr_radius_mm);
  const Volume bone = shape_volume(centred_cube(64, 0.2), [&](const Vec3& p) {
    const double along_mm = axis.dot(p);
    const double to_the_wall_mm = 0.3 + radius_mm - (p - along_mm * axis).norm();
    return std::max(along_mm - 3, std::min(2 + radius_mm + along_mm, to_the_wall_mm));
  });
  const auto felt = prepared_default(algorithm, bone);
  const Quat upright = smallest_rotation(Vec3::UnitZ(), axis);
  const Pose X_W_free{5 * axis, upright};
  Pose X_WD = X_W_free;
  PassivityObserver observer;
  for (int n = 0; n < kPresses; ++n) {
    const Quat lean = quaternion_from_rotation_vector(random.uniform(0, 0.1) * random_direction(random));
    move_device(*felt, X_WD, {random.uniform(-3, 0) * axis + 0.6 * random_direction(random), lean * upright},
                observer);
  }
  move_device(*felt, X_WD, X_W_free, observer);
  return observer.share();
}

}  // namespace

Section energy_given_back() {
  // The wrench lags by half a tick's motion on average: too small on the way in, too large on the way out.
  const double lag = kSpeed_mm_s * kTick_s / kDeep_mm;
  const double ideal = (1 + lag) / (1 - lag);
  Section section{
      "Energy returned to the device",
      fmt::format(
          "Must hold for 4: if a device is pressed {} mm into bone and drawn back at {:.0f} mm/s, the "
          "ratio of energy returned to energy put in is at most 5 % above that of a spring sampled at 1 "
          "kHz, {:.3f}; so is that of a device that is pressed and leant {} times in a hole, with burr "
          "and shaft at once. Measured at the device: the wrench of a tick times the motion until the "
          "next; {} rotations of the scene against the grid; energy returned / put in, median (worst).",
          kDeep_mm, kSpeed_mm_s, ideal, kPresses, kScenes),
      {"algorithm", "burr on a plane", "shaft on an edge", "in a hole", ""},
      {},
      {}};
  for (const std::string& algorithm : algorithm_names()) {
    std::vector<std::vector<double>> shares;
    for (const auto& way : {press_burr_on_plane, press_shaft_on_edge, press_in_hole}) {
      SeededRandom random(7);
      shares.emplace_back();
      for (int n = 0; n < kScenes; ++n) shares.back().push_back(way(algorithm, random));
    }
    std::vector<std::string> cells{algorithm};
    bool holds = true;
    for (const auto& of_way : shares) {
      cells.push_back(median_and_worst(of_way));
      holds = holds && percentile(of_way, 1) <= 1.05 * ideal;
    }
    section.add_of(algorithm, cells, holds);
  }
  return section;
}

}  // namespace osteomill::verification
