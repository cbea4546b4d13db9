#include "osteomill/haptics/algorithms.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

double setting(std::string_view algorithm, const HapticSettings& settings, const std::string& name) {
  for (const SettingDescription& value : setting_values(algorithm_named(algorithm), settings)) {
    if (value.name == name) return value.value;
  }
  ADD_FAILURE() << "no setting " << name;
  return -1;
}

TEST(Algorithms, SortedUniqueKeepsOneEntryPerName) {
  const std::vector<AlgorithmId> once =
      sorted_unique({{"a", "1 a", ""}, {"b", "2 b", ""}, {"a", "3 a", ""}, {"b", "2 b", ""}});
  ASSERT_EQ(once.size(), 2u);
  EXPECT_EQ(once[0].label, "1 a");
  EXPECT_EQ(once[1], "b");
}

TEST(MakeAlgorithm, DefaultsToThePublishedSettings) {
  const HapticSettings paper;
  EXPECT_EQ(setting("line-proxy", paper, "vertices"), 51);
  EXPECT_EQ(setting("line-proxy", paper, "stiffness"), 5);
  EXPECT_EQ(setting("surface-points", paper, "slices"), 20);
  EXPECT_EQ(setting("surface-points", paper, "stiffness"), 20);
  EXPECT_EQ(setting("point-shell", paper, "scale"), 3);
  EXPECT_EQ(setting("point-shell", paper, "translational-stiffness"), 5);
  EXPECT_EQ(setting("point-shell", paper, "torsional-stiffness"), 2500);
}

TEST(MakeAlgorithm, UserOptionsOverrideTheDefaults) {
  HapticSettings settings;
  settings.set_option("stiffness", 3);
  settings.set_option("shell-scale", 2);
  settings.named.push_back({"point-shell", "damping-time", 0});
  EXPECT_EQ(setting("point-shell", settings, "damping-time"), 0);
  EXPECT_EQ(setting("point-shell", settings, "scale"), 2);
  for (const auto& [algorithm, name] :
       {std::pair{"line-proxy", "stiffness"}, std::pair{"surface-points", "stiffness"},
        std::pair{"point-shell", "translational-stiffness"}}) {
    EXPECT_EQ(setting(algorithm, settings, name), 3);
  }
}

// Pushes the shaft's end first against a sheet two voxels thick; the device moves 5 mm past it.
TEST(BarrierShell, KeepsTheShaftFromPiercingASheetUpTo300mmPerSecond) {
  constexpr double kTick_s = 1e-3;
  constexpr double kSheetTop_mm = 0.25;
  const Volume bone = testing_support::shape_volume(
      testing_support::centred_cube(48, 0.25), [](const Vec3& p) { return std::abs(p.z()) - kSheetTop_mm; });
  const MillingTool tool;
  const Vec3 end_T(0, 0, tool.shaft_length_mm);
  for (const double speed_mm_s : {20.0, 50.0, 100.0, 150.0, 200.0, 300.0}) {
    const auto algorithm = make_algorithm(default_algorithm(), HapticSettings{});
    algorithm->prepare({&bone, tool, kTick_s});
    Pose X_WD{Vec3::Zero(), smallest_rotation(Vec3::UnitZ(), -Vec3::UnitZ())};
    HapticStep step;
    double lowest_mm = 2;
    for (double end_z = 2; end_z > -5; end_z -= speed_mm_s * kTick_s) {
      X_WD.position_mm = {0.1, 0.05, end_z + tool.shaft_length_mm};
      step = algorithm->step(X_WD, kTick_s);
      lowest_mm = std::min(lowest_mm, (step.X_WT * end_T).z());
    }
    EXPECT_GT(lowest_mm, kSheetTop_mm - 0.15) << speed_mm_s;
    EXPECT_GT(step.wrench.force_N.z(), 8) << speed_mm_s;
  }
}

TEST(MakeAlgorithm, RefusesInvalidSettings) {
  const auto refused = [](std::string_view algorithm, const HapticSettings& settings) {
    EXPECT_THROW(make_algorithm(algorithm_named(algorithm), settings), std::invalid_argument);
  };
  HapticSettings settings;
  settings.set_option("vertices", 1);
  refused("line-proxy", settings);
  settings = {};
  const auto refused_value = [&](const char* algorithm, const char* setting, double value) {
    settings.named = {{algorithm, setting, value}};
    refused(algorithm, settings);
  };
  refused_value("surface-points", "no-such-thing", 1);
  refused_value("point-shell", "scale", 0);
  refused_value("surface-points", "slices", 2.5);
  refused_value("line-proxy", "stiffness", -1);
  refused_value("point-shell", "torsional-stiffness", std::nan(""));
}

TEST(MakeAlgorithm, PrepareRefusesInputsWithoutAVolume) {
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    EXPECT_THROW(make_algorithm(algorithm, {})->prepare({nullptr, MillingTool{}}), std::invalid_argument)
        << algorithm.id.name;
  }
}

TEST(MakeAlgorithm, PublishedAlgorithmsReportTheirSamplePointCounts) {
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(24, 0.25),
                                                    testing_support::ball(Vec3::Zero(), 2.0));
  const auto count = [&](std::string_view algorithm) {
    const auto made = make_algorithm(algorithm_named(algorithm), {.named = {{"", "shell-scale", 1}}});
    made->prepare({&bone, MillingTool{}});
    return made->sample_point_count();
  };
  EXPECT_EQ(count("line-proxy"), 51);
  EXPECT_EQ(count("surface-points"), 24 + 20 * 8);
  // About the ball's area over the area of a voxel's face; the shell lies slightly inside, and is staircased.
  const double faces = 4 * 3.14159 * 2.0 * 2.0 / (0.25 * 0.25);
  EXPECT_NEAR(count("point-shell"), faces, 0.4 * faces);
}

}  // namespace
}  // namespace osteomill
