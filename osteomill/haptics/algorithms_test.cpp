#include <stdexcept>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/make_algorithm.h"

namespace osteomill {
namespace {

double setting(AlgorithmId algorithm, const HapticSettings& settings, const std::string& name) {
  for (const SettingValue& value : describe_algorithm(algorithm, settings)) {
    if (value.name == name) return value.value;
  }
  ADD_FAILURE() << "no setting " << name;
  return -1;
}

TEST(MakeAlgorithm, DefaultsAreThePapers) {
  const HapticSettings paper{.mode = Mode::paper};
  EXPECT_EQ(setting(AlgorithmId::line_proxy, paper, "vertices"), 51);
  EXPECT_EQ(setting(AlgorithmId::line_proxy, paper, "stiffness"), 2);
  EXPECT_EQ(setting(AlgorithmId::surface_points, paper, "slices"), 20);
  EXPECT_EQ(setting(AlgorithmId::surface_points, paper, "stiffness"), 20);
  EXPECT_EQ(setting(AlgorithmId::point_shell, paper, "scale"), 1);
  EXPECT_EQ(setting(AlgorithmId::point_shell, paper, "translational-stiffness"), 2);
  EXPECT_EQ(setting(AlgorithmId::point_shell, paper, "points-on-isosurface"), 0);
  EXPECT_EQ(setting(AlgorithmId::point_shell, {.mode = Mode::steady}, "points-on-isosurface"), 1);
}

TEST(MakeAlgorithm, WhatTheUserSaysWins) {
  HapticSettings settings{.mode = Mode::steady};
  settings.stiffness_N_per_mm = 3;
  settings.shell_scale = 2;
  settings.named = {{AlgorithmId::point_shell, "points-on-isosurface", 0},
                    {AlgorithmId::line_proxy, "clamp-fraction", 0}};
  EXPECT_EQ(setting(AlgorithmId::point_shell, settings, "points-on-isosurface"), 0);
  EXPECT_EQ(setting(AlgorithmId::point_shell, settings, "area-weights"), 1);
  EXPECT_EQ(setting(AlgorithmId::point_shell, settings, "scale"), 2);
  EXPECT_EQ(setting(AlgorithmId::line_proxy, settings, "clamp-fraction"), 0);
  for (const auto& [algorithm, name] :
       {std::pair{AlgorithmId::line_proxy, "stiffness"}, std::pair{AlgorithmId::surface_points, "stiffness"},
        std::pair{AlgorithmId::point_shell, "translational-stiffness"}}) {
    EXPECT_EQ(setting(algorithm, settings, name), 3);
  }
}

TEST(MakeAlgorithm, WhatCannotBeIsRefused) {
  const auto refused = [](AlgorithmId algorithm, const HapticSettings& settings) {
    EXPECT_THROW(make_algorithm(algorithm, settings), std::invalid_argument);
  };
  HapticSettings settings;
  settings.vertices = 1;
  refused(AlgorithmId::line_proxy, settings);
  settings = {};
  settings.named = {{AlgorithmId::surface_points, "no-such-thing", 1}};
  refused(AlgorithmId::surface_points, settings);
  settings.named = {{AlgorithmId::surface_points, "march-to-surface", 0.5}};
  refused(AlgorithmId::surface_points, settings);
  settings.named = {{AlgorithmId::surface_points, "slices", 2.5}};
  refused(AlgorithmId::surface_points, settings);
}

TEST(MakeAlgorithm, EachCountsItsSamplePoints) {
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(24, 0.25),
                                                    testing_support::ball(Vec3::Zero(), 2.0));
  const auto count = [&](AlgorithmId algorithm) {
    const auto made = make_algorithm(algorithm, {.mode = Mode::paper});
    made->prepare({&bone, MillingTool{}});
    return made->sample_point_count();
  };
  EXPECT_EQ(count(AlgorithmId::line_proxy), 51);
  EXPECT_EQ(count(AlgorithmId::surface_points), 24 + 20 * 8);
  // About the ball's area over the area of a voxel's face; the shell is some way inside, and staircased.
  const double faces = 4 * 3.14159 * 2.0 * 2.0 / (0.25 * 0.25);
  EXPECT_NEAR(count(AlgorithmId::point_shell), faces, 0.4 * faces);
}

}  // namespace
}  // namespace osteomill
