#include "osteomill/base/wrench.h"

#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

constexpr WrenchLimits kLimits{20, 500};

TEST(SafeWrench, KeepsAWrenchWithinItsLimits) {
  const SafeWrench safe = make_safe({{3, 4, 0}, {0, 0, 500}}, kLimits);
  EXPECT_EQ(safe.fault, WrenchFault::none);
  EXPECT_EQ(safe.wrench.force_N, Vec3(3, 4, 0));
  EXPECT_EQ(safe.wrench.torque_Nmm, Vec3(0, 0, 500));
}

TEST(SafeWrench, ClampsForceAndTorqueKeepingTheirDirections) {
  const SafeWrench safe = make_safe({{30, 40, 0}, {0, 0, -1000}}, kLimits);
  EXPECT_EQ(safe.fault, WrenchFault::force_and_torque_clamped);
  EXPECT_TRUE(safe.wrench.force_N.isApprox(Vec3(12, 16, 0)));
  EXPECT_TRUE(safe.wrench.torque_Nmm.isApprox(Vec3(0, 0, -500)));
}

TEST(SafeWrench, ReplacesANonFiniteWrenchByZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double huge = std::numeric_limits<double>::max();
  for (const Wrench& bad : {Wrench{{nan, 0, 0}, {0, 0, 0}}, Wrench{{1, 0, 0}, {0, 1 / 0.0, 0}},
                            Wrench{{huge, huge, 0}, {0, 0, 0}}}) {
    const SafeWrench safe = make_safe(bad, kLimits);
    EXPECT_EQ(safe.fault, WrenchFault::not_finite);
    EXPECT_EQ(safe.wrench.force_N, Vec3::Zero());
    EXPECT_EQ(safe.wrench.torque_Nmm, Vec3::Zero());
  }
}

TEST(WrenchFault, HasADistinctNameForEachCode) {
  std::set<std::string_view> names;
  for (int code = 0; code <= static_cast<int>(WrenchFault::held_back); ++code)
    names.insert(name_of(static_cast<WrenchFault>(code)));
  EXPECT_EQ(names.size(), 10u);
  EXPECT_FALSE(names.contains("unknown"));
  EXPECT_EQ(name_of(WrenchFault::pose_jumped), "pose jumped");
  EXPECT_EQ(name_of(static_cast<WrenchFault>(200)), "unknown");
}

}  // namespace
}  // namespace osteomill
