#include "osteomill/tool/sample_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/tool/milling_tool.h"

namespace osteomill {
namespace {

const MillingTool kTool{1.5, 1.0, 25.0};

TEST(CentrelineVertices, RunFromTheBurrsCentreToTheShaftsEnd) {
  const auto vertices = centreline_vertices(kTool, 51);
  ASSERT_EQ(vertices.size(), 51u);
  EXPECT_EQ(vertices.front(), Vec3(0, 0, 0));
  EXPECT_LT((vertices.back() - Vec3(0, 0, 25)).norm(), 1e-12);
  for (std::size_t n = 1; n < vertices.size(); ++n) {
    EXPECT_LT((vertices[n] - vertices[n - 1] - Vec3(0, 0, 0.5)).norm(), 1e-12);
  }
  EXPECT_EQ(centreline_vertices(kTool, 1).size(), 1u);
  EXPECT_THROW(centreline_vertices(kTool, 0), std::invalid_argument);
}

TEST(SphereVertices, AreSpreadAsWidelyAs24PointsCanBe) {
  const auto vertices = sphere_vertices(kTool);
  for (const Vec3& vertex : vertices) EXPECT_NEAR(vertex.norm(), 1.5, 1e-12);
  double min_deg = 180;
  for (std::size_t a = 0; a < vertices.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double cosine = vertices[a].dot(vertices[b]) / (1.5 * 1.5);
      min_deg = std::min(min_deg, std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi);
    }
  }
  EXPECT_NEAR(min_deg, 43.6908, 1e-4);  // the published answer of Tammes' problem for 24
}

// Balanced: no direction is favoured to first or second order.
TEST(SphereVertices, HaveTheMomentsOfASphere) {
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const Vec3& vertex : sphere_vertices(kTool)) {
    first += vertex;
    second += vertex * vertex.transpose();
  }
  EXPECT_LT(first.norm(), 1e-12);
  EXPECT_LT((second - 24 * 1.5 * 1.5 / 3 * Mat3::Identity()).norm(), 1e-9);
}

TEST(SliceVertices, LieOnTheFreeShaft) {
  const auto slices = slice_vertices(kTool, 20);
  ASSERT_EQ(slices.size(), 20u);
  for (const ShaftSlice& slice : slices) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& vertex : slice.vertices_T) {
      EXPECT_NEAR(tool_distance(kTool, vertex).distance_mm, 0, 1e-12);
      EXPECT_EQ(vertex.z(), slice.centre_T.z());
      sum += vertex;
    }
    EXPECT_LT((sum / kSliceVertices - slice.centre_T).norm(), 1e-12);
  }
}

TEST(SliceVertices, EachStandsForAnEqualLength) {
  const auto slices = slice_vertices(kTool, 20);
  const double start = std::sqrt(1.5 * 1.5 - 1.0);
  const double share = (25 - start) / 20;
  EXPECT_NEAR(slices.front().centre_T.z(), start + 0.5 * share, 1e-12);
  EXPECT_NEAR(slices.back().centre_T.z(), 25 - 0.5 * share, 1e-12);
}

TEST(SliceVertices, AShaftInsideTheBurrHasNone) {
  EXPECT_TRUE(slice_vertices({1.5, 1.0, 1.0}, 20).empty());
  EXPECT_EQ(shaft_start_mm({1.0, 2.0, 10}), 0);
  EXPECT_THROW(slice_vertices(kTool, 0), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
