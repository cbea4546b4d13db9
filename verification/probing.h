#pragma once

#include <array>
#include <memory>
#include <numbers>
#include <vector>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/hand.h"

#include "tests/shapes.h"

namespace osteomill::verification {

inline constexpr double kTick_s = 1e-3;
inline constexpr double kDegrees = 180 / std::numbers::pi;

/// Returns a unit vector, uniformly distributed over the sphere.
Vec3 random_direction(SeededRandom& random);
Quat random_orientation(SeededRandom& random);

/// Returns the algorithm, prepared for the volume, with default settings except the stiffness and `named`.
/// The volume must outlive it.
std::unique_ptr<HapticAlgorithm> prepared(std::string_view algorithm, const Volume& volume,
                                          const MillingTool& tool, double stiffness_N_per_mm,
                                          std::vector<HapticSettings::Named> named = {});

/// Moves the device from `from_W` to `to_W` in steps of 0.02 mm and waits there. Returns the last step.
HapticStep approach(HapticAlgorithm& algorithm, const Vec3& from_W, const Vec3& to_W,
                    const Quat& orientation);

}  // namespace osteomill::verification
