#include "osteomill/haptics/line_proxy/tool_clearance.h"

#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill::line_proxy {
namespace {

using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

class ToolClearanceTest : public ::testing::Test {
 protected:
  std::optional<Vec3> move(const Vec3& tip_W, const Vec3& shaft) const {
    return clearing_move(bone_, tool_, {tip_W, smallest_rotation(Vec3::UnitZ(), shaft)}, NormalRule{});
  }
  MillingTool tool_;
  Volume bone_ = shape_volume(centred_cube(160, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
};

TEST_F(ToolClearanceTest, AToolThatDoesNotReachBoneStays) {
  EXPECT_FALSE(move({0, 0, 1.51}, {0.2, 0.1, 1}));
}

TEST_F(ToolClearanceTest, ABurrMovesOutByWhatItsRadiusReachesIn) {
  const auto moved = move({0.1, 0.2, 0.9}, {0.2, 0.1, 1});
  ASSERT_TRUE(moved);
  EXPECT_LT((*moved - Vec3(0, 0, 0.6)).norm(), 0.03);
}

TEST_F(ToolClearanceTest, AShaftThatLiesOnBoneMovesOut) {
  // The burr is 2 mm up, the shaft comes down to 0.3 mm at its end.
  const auto moved = move({-12, 0, 2.0}, {1, 0, -1.7 / 25});
  ASSERT_TRUE(moved);
  EXPECT_NEAR(moved->z(), 0.7, 0.1);
}

}  // namespace
}  // namespace osteomill::line_proxy
