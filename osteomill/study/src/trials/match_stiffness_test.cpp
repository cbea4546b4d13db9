#include "osteomill/study/match_stiffness.h"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/probe_bones.h"

namespace osteomill {
namespace {

const MillingTool kTool;
constexpr double kTick_s = 1e-3;

const Volume& wall() {
  static const Volume volume = flat_wall(kTool);
  return volume;
}

MillingSetup setup_of(const AlgorithmDescription& algorithm) {
  return {.tool = kTool, .algorithm = algorithm, .tick_s = kTick_s};
}

// Returns the force at rest at this depth, approached from outside.
double force_at_rest_N(HapticAlgorithm& algorithm, double depth_mm) {
  Pose X_WD;
  double force_N = 0;
  algorithm.reset();
  for (double at_mm = -0.5; at_mm < depth_mm; at_mm += 0.01) {
    X_WD.position_mm.z() = kTool.burr_radius_mm - at_mm;
    algorithm.step(X_WD, kTick_s);
  }
  X_WD.position_mm.z() = kTool.burr_radius_mm - depth_mm;
  for (int n = 0; n < 300; ++n) force_N = algorithm.step(X_WD, kTick_s).wrench.force_N.z();
  return force_N;
}

// Returns the slope between 0.4 and 0.6 N, from forces at rest.
double slope_at_rest_N_per_mm(HapticAlgorithm& algorithm) {
  std::optional<double> from_mm, from_N;
  for (double depth_mm = -0.2; depth_mm < 3; depth_mm += 0.02) {
    const double force_N = force_at_rest_N(algorithm, depth_mm);
    if (!from_mm && force_N >= 0.4) {
      from_mm = depth_mm;
      from_N = force_N;
    }
    if (from_mm && force_N >= 0.6) return (force_N - *from_N) / (depth_mm - *from_mm);
  }
  return 0;
}

// Returns all algorithms except the one whose force rises in steps.
std::vector<std::string> cases() {
  std::vector<std::string> all = algorithm_names();
  std::erase(all, "surface-points");
  return all;
}

class MatchStiffness : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Algorithms, MatchStiffness, ::testing::ValuesIn(cases()), [](const auto& of) {
  std::string name = of.param;
  std::erase(name, '-');
  return name;
});

TEST_P(MatchStiffness, FeltStiffnessIsWithinTenPercentOfTheRequested) {
  const AlgorithmDescription& algorithm = algorithm_named(GetParam());
  HapticSettings haptics;
  const double felt_N_per_mm = 0.8;
  haptics.named.push_back(match_felt_stiffness(felt_N_per_mm, setup_of(algorithm), wall()));
  const auto made = make_algorithm(algorithm, haptics);
  made->prepare({&wall(), kTool, kTick_s});
  EXPECT_NEAR(slope_at_rest_N_per_mm(*made), felt_N_per_mm, 0.1 * felt_N_per_mm)
      << "at " << haptics.named.back().value;
}

TEST(MatchStiffness, LineProxySettingEqualsTheFeltStiffness) {
  const auto named = match_felt_stiffness(1.3, setup_of(algorithm_named("line-proxy")), wall());
  EXPECT_EQ(named.setting, "stiffness");
  EXPECT_NEAR(named.value, 1.3, 0.02 * 1.3);
}

TEST(MatchStiffness, RefusesAStiffnessThatNoSettingReaches) {
  for (const std::string& name : algorithm_names()) {
    const MillingSetup setup = setup_of(algorithm_named(name));
    EXPECT_THROW(match_felt_stiffness(1e4, setup, wall()), std::invalid_argument) << name;
    EXPECT_THROW(match_felt_stiffness(1e-4, setup, wall()), std::invalid_argument) << name;
  }
}

// Surface-points adds one ring of vertices after another, each saturating once it is entirely in bone.
TEST(MatchStiffness, RefusesAStiffnessThatTheForceCurveSkips) {
  try {
    match_felt_stiffness(1.5, setup_of(algorithm_named("surface-points")), wall());
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("surface-points cannot be felt as 1.5 N/mm"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace osteomill
