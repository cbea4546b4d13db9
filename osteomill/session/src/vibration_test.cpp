#include <gtest/gtest.h>

#include "osteomill/session/milling_session.h"

namespace osteomill {
namespace {

TEST(Vibration, IsZeroByDefault) {
  Vibration none({});
  EXPECT_EQ(none.force_N({}, 5, 40000, 1e-3), Vec3::Zero());
}

TEST(Vibration, FrequencyFollowsTheSpindleUpTo250Hz) {
  EXPECT_DOUBLE_EQ(vibration_hz(3000), 50);
  EXPECT_DOUBLE_EQ(vibration_hz(6000), 100);
  EXPECT_NEAR(vibration_hz(1e6), 250, 1e-9);
}

TEST(Vibration, FrequencyRisesWithTheSpindleSpeedWithoutJumps) {
  double before_hz = vibration_hz(999);
  for (double rpm = 1000; rpm <= 1e6; ++rpm) {
    const double hz = vibration_hz(rpm);
    ASSERT_GT(hz, before_hz) << rpm;
    ASSERT_LT(hz - before_hz, 0.02) << rpm;
    before_hz = hz;
  }
}

TEST(Vibration, RotatesAboutTheShaftScaledByBurrForceUpToItsLimit) {
  const Pose X_WT{{1, 2, 3}, quaternion_from_rotation_vector({0.5, -0.2, 0.1})};
  const VibrationSettings settings{.on = true};
  Vibration vibration(settings);
  Vec3 sum = Vec3::Zero();
  constexpr int kTicks = 1000;
  int crossings = 0;
  double before = 0;
  for (int n = 0; n < kTicks; ++n) {
    const Vec3 force_N = vibration.force_N(X_WT, 2, 6000, 1e-3);
    EXPECT_NEAR(force_N.norm(), 0.16, 1e-12);
    EXPECT_NEAR(force_N.dot(shaft_direction(X_WT)), 0, 1e-12);
    const double across = force_N.dot(X_WT.orientation * Vec3(0.8, 0.6, 0));
    crossings += before < 0 && across >= 0 ? 1 : 0;
    before = across;
    sum += force_N;
  }
  EXPECT_NEAR(crossings, 100, 1);
  EXPECT_LT(sum.norm() / kTicks, 1e-3);
  EXPECT_NEAR(vibration.force_N(X_WT, 100, 6000, 1e-3).norm(), settings.max_N, 1e-12);
  EXPECT_EQ(vibration.force_N(X_WT, 0, 6000, 1e-3), Vec3::Zero());
  EXPECT_EQ(vibration.force_N(X_WT, 2, 0, 1e-3), Vec3::Zero());
}

}  // namespace
}  // namespace osteomill
