#include "osteomill/haptics/algorithms.h"

#include <stdexcept>

#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill {
namespace {

double setting(std::string_view algorithm, const HapticSettings& settings, const std::string& name) {
  for (const SettingValue& value : setting_values(algorithm_named(algorithm), settings)) {
    if (value.name == name) return value.value;
  }
  ADD_FAILURE() << "no setting " << name;
  return -1;
}

TEST(MakeAlgorithm, DefaultsAreThePapers) {
  const HapticSettings paper{.mode = Mode::paper};
  EXPECT_EQ(setting("line-proxy", paper, "vertices"), 51);
  EXPECT_EQ(setting("line-proxy", paper, "stiffness"), 2);
  EXPECT_EQ(setting("surface-points", paper, "slices"), 20);
  EXPECT_EQ(setting("surface-points", paper, "stiffness"), 20);
  EXPECT_EQ(setting("point-shell", paper, "scale"), 1);
  EXPECT_EQ(setting("point-shell", paper, "translational-stiffness"), 2);
  EXPECT_EQ(setting("point-shell", paper, "surface-shell"), 0);
  EXPECT_EQ(setting("point-shell", {.mode = Mode::steady}, "surface-shell"), 1);
}

TEST(MakeAlgorithm, WhatTheUserSaysWins) {
  HapticSettings settings{.mode = Mode::steady};
  settings.set_option("stiffness", 3);
  settings.set_option("shell-scale", 2);
  settings.named.push_back({"point-shell", "surface-shell", 0});
  EXPECT_EQ(setting("point-shell", settings, "surface-shell"), 0);
  EXPECT_EQ(setting("point-shell", settings, "guarded-move"), 1);
  EXPECT_EQ(setting("point-shell", settings, "scale"), 2);
  for (const auto& [algorithm, name] :
       {std::pair{"line-proxy", "stiffness"}, std::pair{"surface-points", "stiffness"},
        std::pair{"point-shell", "translational-stiffness"}}) {
    EXPECT_EQ(setting(algorithm, settings, name), 3);
  }
}

TEST(Algorithms, WhatHasOneModeRunsOnce) {
  const std::vector<Mode> both{Mode::paper, Mode::steady};
  EXPECT_TRUE(runs_in(algorithm_named("point-shell"), Mode::paper, both));
  EXPECT_TRUE(runs_in(algorithm_named("point-shell"), Mode::steady, both));
  EXPECT_FALSE(runs_in(algorithm_named("barrier-shell"), Mode::paper, both));
  EXPECT_TRUE(runs_in(algorithm_named("barrier-shell"), Mode::steady, both));
  EXPECT_TRUE(runs_in(algorithm_named("barrier-shell"), Mode::paper, {Mode::paper}));
}

TEST(MakeAlgorithm, WhatCannotBeIsRefused) {
  const auto refused = [](std::string_view algorithm, const HapticSettings& settings) {
    EXPECT_THROW(make_algorithm(algorithm, settings), std::invalid_argument);
  };
  HapticSettings settings;
  settings.set_option("vertices", 1);
  refused("line-proxy", settings);
  settings = {};
  settings.named = {{"surface-points", "no-such-thing", 1}};
  refused("surface-points", settings);
  settings.named = {{"surface-points", "hold-tool", 0.5}};
  refused("surface-points", settings);
  settings.named = {{"surface-points", "slices", 2.5}};
  refused("surface-points", settings);
}

TEST(MakeAlgorithm, EachCountsItsSamplePoints) {
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(24, 0.25),
                                                    testing_support::ball(Vec3::Zero(), 2.0));
  const auto count = [&](std::string_view algorithm) {
    const auto made = make_algorithm(algorithm, {.mode = Mode::paper});
    made->prepare({&bone, MillingTool{}});
    return made->sample_point_count();
  };
  EXPECT_EQ(count("line-proxy"), 51);
  EXPECT_EQ(count("surface-points"), 24 + 20 * 8);
  // About the ball's area over the area of a voxel's face; the shell is some way inside, and staircased.
  const double faces = 4 * 3.14159 * 2.0 * 2.0 / (0.25 * 0.25);
  EXPECT_NEAR(count("point-shell"), faces, 0.4 * faces);
}

}  // namespace
}  // namespace osteomill
