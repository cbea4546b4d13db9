#include "osteomill/haptics/line_proxy/equations.h"

#include <cmath>

#include <gtest/gtest.h>

namespace osteomill::line_proxy {
namespace {

TEST(LineProxyEquations, TheFractionIsWhereTheDensityPassesTheIsovalue) {
  EXPECT_DOUBLE_EQ(crossing_fraction(200, 600, 500), 0.75);
  EXPECT_DOUBLE_EQ(crossing_fraction(500, 600, 500), 0.0);
}

TEST(LineProxyEquations, AsPrintedTheFractionOfAVertexAlreadyInsideIsFarOff) {
  EXPECT_DOUBLE_EQ(crossing_fraction(900, 901, 500), -400.0);
  EXPECT_TRUE(std::isinf(crossing_fraction(900, 900, 500)));
}

TEST(LineProxyEquations, TheIntersectionPointLiesThatFarIntoTheStep) {
  EXPECT_TRUE(intersection_point({1, 2, 3}, {1, 4, 3}, 0.75).isApprox(Vec3(1, 3.5, 3)));
}

TEST(LineProxyEquations, StepsDivideTheWayEvenly) {
  EXPECT_TRUE(translation_step({1, -2, 4}, 10).isApprox(Vec3(0.1, -0.2, 0.4)));
  EXPECT_TRUE(rotation_step({0, 0, 0.5}, 5).isApprox(Vec3(0, 0, 0.1)));
}

TEST(LineProxyEquations, TheTipIsPulledToItsProxy) {
  EXPECT_TRUE(tip_force(2.0, {0, 0, 1}, {0, 0, 0.5}).isApprox(Vec3(0, 0, 1)));
}

// A shaft along z, tip at the origin; the surface holds it 3 to the side at height 4 (a 3-4-5 triangle). The
// probe's point is 5 up the shaft, so g = (3, 0, -1), F = 2 g = (6, 0, -2), T = (3, 0, 4) x F = (0, 30, 0).
TEST(LineProxyEquations, TheShaftTurnsAboutTheTipBackToTheSurface) {
  const Vec3 proxy = Vec3::Zero();
  const Vec3 intersection(3, 0, 4);
  const Vec3 r = arm(intersection, proxy);
  EXPECT_EQ(r, Vec3(3, 0, 4));
  const Vec3 probe = probe_intersection(r, Vec3::UnitZ(), proxy);
  EXPECT_EQ(probe, Vec3(0, 0, 5));
  const Vec3 g = orientation_error(intersection, probe);
  EXPECT_EQ(g, Vec3(3, 0, -1));
  const Vec3 force = reaction_force(2.0, g);
  EXPECT_EQ(force, Vec3(6, 0, -2));
  EXPECT_EQ(torque(r, force), Vec3(0, 30, 0));
}

TEST(LineProxyEquations, AMovedProxyChangesNothingButThePlace) {
  const Vec3 proxy(10, -7, 2);
  const Vec3 r = arm(proxy + Vec3(3, 0, 4), proxy);
  EXPECT_EQ(r, Vec3(3, 0, 4));
  EXPECT_EQ(probe_intersection(r, Vec3::UnitZ(), proxy), proxy + Vec3(0, 0, 5));
}

TEST(LineProxyEquations, TheShaftIsDrawnARadiusOffTheSurface) {
  const Vec3 offset = offset_point({0, 0, 10}, {1, 0, 0}, 1.0);
  EXPECT_EQ(offset, Vec3(1, 0, 10));
  EXPECT_EQ(drawn_shaft(offset, {0.5, 0, 0}), Vec3(0.5, 0, 10));
}

}  // namespace
}  // namespace osteomill::line_proxy
