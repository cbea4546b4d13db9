#include "verification/probing.h"

#include <algorithm>
#include <cmath>

namespace osteomill::verification {

Vec3 random_direction(SeededRandom& random) {
  const double z = random.uniform(-1, 1);
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  const double across = std::sqrt(1 - z * z);
  return {across * std::cos(angle), across * std::sin(angle), z};
}

Quat random_orientation(SeededRandom& random) {
  const Quat tilted = smallest_rotation(Vec3::UnitZ(), random_direction(random));
  return tilted * quaternion_from_rotation_vector({0, 0, random.uniform(0, 2 * std::numbers::pi)});
}

std::unique_ptr<HapticAlgorithm> prepared(std::string_view algorithm, const Volume& volume,
                                          const MillingTool& tool, double stiffness_N_per_mm,
                                          std::vector<HapticSettings::Named> named) {
  HapticSettings settings;
  settings.named = std::move(named);
  settings.set_option("stiffness", stiffness_N_per_mm);
  auto made = make_algorithm(algorithm_named(algorithm), settings);
  made->prepare({&volume, tool});
  return made;
}

HapticStep approach(HapticAlgorithm& algorithm, const Vec3& from_W, const Vec3& to_W,
                    const Quat& orientation) {
  const int moves = std::max(1, static_cast<int>(std::ceil((to_W - from_W).norm() / 0.02)));
  for (int n = 0; n < moves; ++n) {
    algorithm.step({from_W + (to_W - from_W) * n / moves, orientation}, kTick_s);
  }
  HapticStep step;
  for (int n = 0; n < 100; ++n) step = algorithm.step({to_W, orientation}, kTick_s);
  return step;
}

}  // namespace osteomill::verification
