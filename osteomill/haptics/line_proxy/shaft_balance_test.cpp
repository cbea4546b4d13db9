#include "osteomill/haptics/line_proxy/shaft_balance.h"

#include <gtest/gtest.h>

namespace osteomill::line_proxy {
namespace {

// A contact 0.5 mm deep with the line's tip at the device's, that leads out along +x.
constexpr double kDepth_mm = 0.5;
const ShaftContact kContact{10.0, Vec3::UnitX(), kDepth_mm};
constexpr ShaftSprings kSprings{2.0, 8.0};
const Vec3 kDevice(1, 2, 3);

// Two springs in a row: the tip gives way, then the shaft turns.
TEST(ShaftBalance, AFreeTipSharesTheDepthWithTheShaft) {
  EXPECT_NEAR(balanced_reaction_N(kContact, kDevice, kDevice, std::nullopt, kSprings),
              kDepth_mm / (1.0 / 2.0 + 1.0 / 8.0), 1e-12);
}

TEST(ShaftBalance, WhereTheLineWasLaidDoesNotMatter) {
  ShaftContact shallower = kContact;
  shallower.depth_mm -= 0.3;
  EXPECT_NEAR(balanced_reaction_N(shallower, kDevice + 0.3 * Vec3::UnitX(), kDevice, std::nullopt, kSprings),
              balanced_reaction_N(kContact, kDevice, kDevice, std::nullopt, kSprings), 1e-12);
}

// A wall on the other side holds the tip where it is: all of the depth is the shaft's.
TEST(ShaftBalance, AWedgedTipLeavesTheShaftAllOfIt) {
  const TipRest wall{kDevice, -Vec3::UnitX()};
  EXPECT_NEAR(balanced_reaction_N(kContact, kDevice, kDevice, wall, kSprings), 8.0 * kDepth_mm, 1e-12);
}

TEST(ShaftBalance, AFloorUnderTheTipDoesNotHinderASidewaysPush) {
  const TipRest floor{kDevice + 0.7 * Vec3::UnitZ(), Vec3::UnitZ()};
  EXPECT_NEAR(balanced_reaction_N(kContact, kDevice, kDevice, floor, kSprings),
              balanced_reaction_N(kContact, kDevice, kDevice, std::nullopt, kSprings), 1e-12);
}

// A wall 0.1 mm further on stops the tip on its way out: no leap between free and wedged.
TEST(ShaftBalance, IsContinuousWhereTheTipComesToRest) {
  const double free_N = balanced_reaction_N(kContact, kDevice, kDevice, std::nullopt, kSprings);
  const double pushed_mm = free_N / kSprings.tip_N_per_mm;
  for (const double aside_mm : {-1e-6, 1e-6}) {
    const TipRest wall{kDevice + (pushed_mm + aside_mm) * Vec3::UnitX(), -Vec3::UnitX()};
    EXPECT_NEAR(balanced_reaction_N(kContact, kDevice, kDevice, wall, kSprings), free_N, 1e-4);
  }
}

TEST(ShaftBalance, NeverPulls) {
  const Vec3 away = kDevice - 2.0 * Vec3::UnitX();
  EXPECT_EQ(balanced_reaction_N(kContact, away, kDevice, std::nullopt, kSprings), 0.0);
}

}  // namespace
}  // namespace osteomill::line_proxy
