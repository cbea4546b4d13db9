#include "tool/sampled_distance_field.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace osteomill {
namespace {

using testing_support::uniform;

const MillingTool kTool{1.5, 1.0, 25.0};

// Points at contact depths, away from the tool's creases (the seam of burr and shaft, the rim of the flat
// end, the axis), which interpolation cannot follow.
bool is_smooth_near(const Vec3& point, double reach_mm) {
  const double distance = tool_distance(kTool, point).distance_mm;
  if (std::abs(distance) > 0.6) return false;
  for (int n = 0; n < 27; ++n) {
    const Vec3 offset(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    const Vec3 shifted = point + reach_mm * offset;
    if (tool_distance(kTool, point).outward_T.dot(tool_distance(kTool, shifted).outward_T) < 0.97)
      return false;
  }
  return true;
}

TEST(SampledDistanceField, MatchesTheClosedFormWithinItsSpacingSquared) {
  std::mt19937 bits(7);
  for (const double spacing_mm : {0.1, 0.05}) {
    const SampledDistanceField field(kTool, spacing_mm);
    int tested = 0;
    for (int n = 0; n < 4000; ++n) {
      const Vec3 point(uniform(bits, -1.7, 1.7), uniform(bits, -1.7, 1.7), uniform(bits, -1.7, 25.2));
      if (!is_smooth_near(point, 1.01 * spacing_mm)) continue;
      const ToolDistance exact = tool_distance(kTool, point);
      const auto sampled = field.at(point);
      if (!sampled) {
        EXPECT_GT(exact.distance_mm, 0) << point.transpose();
        continue;
      }
      ++tested;
      EXPECT_NEAR(sampled->distance_mm, exact.distance_mm, spacing_mm * spacing_mm / 1.5)
          << point.transpose();
      EXPECT_GT(sampled->outward_T.dot(exact.outward_T), std::cos(0.06 * spacing_mm / 0.1));
      EXPECT_NEAR(sampled->outward_T.norm(), 1, 1e-9);
    }
    EXPECT_GT(tested, 500);
  }
}

TEST(SampledDistanceField, HalvingTheSpacingQuartersTheError) {
  const auto worst_on_burr = [](double spacing_mm) {
    const SampledDistanceField field(kTool, spacing_mm);
    double worst = 0;
    for (int n = 0; n < 2000; ++n) {
      const double polar = 1.7 + 1.4 * n / 2000.0, around = 0.37 * n;
      const Vec3 point =
          1.4 * Vec3(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
      worst = std::max(worst, std::abs(field.at(point)->distance_mm + 0.1));
    }
    return worst;
  };
  EXPECT_NEAR(worst_on_burr(0.1) / worst_on_burr(0.05), 4, 0.6);
}

TEST(SampledDistanceField, IsExactAtNodesAndContainsTheTool) {
  const SampledDistanceField field(kTool, 0.25);
  const Vec3 node = field.box().min_mm + 0.25 * Vec3(4, 5, 6);
  EXPECT_NEAR(field.at(node)->distance_mm, tool_distance(kTool, node).distance_mm, 1e-6);
  const ToolBox tool = bounding_box(kTool);
  EXPECT_TRUE((field.box().min_mm.array() < tool.min_mm.array() - 0.4).all());
  EXPECT_TRUE((field.box().max_mm.array() > tool.max_mm.array() + 0.4).all());
  EXPECT_FALSE(field.at({0, 0, 40}));
  EXPECT_FALSE(field.at({std::nan(""), 0, 0}));
}

TEST(SampledDistanceField, RefusesASpacingOutOfRange) {
  EXPECT_THROW(SampledDistanceField(kTool, 0), std::invalid_argument);
  EXPECT_THROW(SampledDistanceField(kTool, std::nan("")), std::invalid_argument);
  EXPECT_THROW(SampledDistanceField(kTool, 1e-4), std::invalid_argument);
  EXPECT_THROW(SampledDistanceField({0, 1, 25}, 0.1), std::invalid_argument);
}

TEST(SampledDistanceField, SuitableSpacingIsAcceptedForAnExtremeTool) {
  EXPECT_NEAR(SampledDistanceField::suitable_spacing_mm(kTool), 0.04, 0.02);
  EXPECT_NO_THROW(
      SampledDistanceField({0.2, 3, 80}, SampledDistanceField::suitable_spacing_mm({0.2, 3, 80})));
}

}  // namespace
}  // namespace osteomill
