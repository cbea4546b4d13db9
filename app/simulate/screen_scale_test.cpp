#include "app/simulate/screen_scale.h"

#include <gtest/gtest.h>

namespace osteomill::app {
namespace {

TEST(ScreenScale, UsesTheSystemScaleAboveOne) {
  EXPECT_DOUBLE_EQ(scale_for({{1920, 1080}, 300, 1.5}), 1.5);
  EXPECT_DOUBLE_EQ(scale_for({{3840, 2160}, 340, 2}), 2);
}

TEST(ScreenScale, FollowsPixelDensityWithoutASystemScale) {
  // 4K at 27 inches (163 dpi) and at 15.6 inches (282 dpi).
  EXPECT_DOUBLE_EQ(scale_for({{3840, 2160}, 336, 1}), 1.5);
  EXPECT_DOUBLE_EQ(scale_for({{3840, 2160}, 194, 1}), 2.75);
  // Ordinary screens: 24 inches, a small laptop, 1024 x 600.
  EXPECT_DOUBLE_EQ(scale_for({{1920, 1080}, 299, 1}), 1);
  EXPECT_DOUBLE_EQ(scale_for({{1366, 768}, 173, 1}), 1);
  EXPECT_DOUBLE_EQ(scale_for({{1024, 600}, 159, 1}), 1);
}

TEST(ScreenScale, FollowsPixelRowsIfTheScreenSizeIsUnknown) {
  EXPECT_DOUBLE_EQ(scale_for({{3840, 2160}, 0, 1}), 2);
  EXPECT_DOUBLE_EQ(scale_for({{1920, 1080}, 0, 1}), 1);
}

TEST(ScreenScale, IsReducedToFitTheWindowButNotBelowTheMinimum) {
  EXPECT_DOUBLE_EQ(fitting_scale(2, {1920, 1080}), 2);
  EXPECT_DOUBLE_EQ(fitting_scale(1, {1024, 600}), 1);
  EXPECT_LT(fitting_scale(2, {1024, 600}), 1.4);
  EXPECT_GE(fitting_scale(2, {1024, 600}), 1.3);
  EXPECT_DOUBLE_EQ(fitting_scale(1, {300, 200}), kMinScale);
}

}  // namespace
}  // namespace osteomill::app
