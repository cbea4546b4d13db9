#include "osteomill/study/noticeable.h"

#include <gtest/gtest.h>

#include "osteomill/study/metrics.h"

namespace osteomill {
namespace {

TEST(Noticeable, ThresholdIsAShareOfForceAndTorqueAndAFixedAngle) {
  EXPECT_DOUBLE_EQ(least_noticeable(metric("force_mean_N"), 2), 0.14);
  EXPECT_DOUBLE_EQ(least_noticeable(metric("torque_mean_Nmm"), 2), 0.26);
  EXPECT_DOUBLE_EQ(least_noticeable(metric("force_hp_rms_N"), 2), 0.4);
  EXPECT_DOUBLE_EQ(least_noticeable(metric("torque_hp_share"), 2), 0.4);
  EXPECT_DOUBLE_EQ(least_noticeable(metric("shaft_spread_deg"), 0.05), 2);
  EXPECT_EQ(least_noticeable(metric("removed_mm3"), 50), 0);
  EXPECT_EQ(least_noticeable(metric("tick_us_median"), 50), 0);
}

}  // namespace
}  // namespace osteomill
