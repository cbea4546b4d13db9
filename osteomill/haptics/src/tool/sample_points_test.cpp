#include "osteomill/haptics/sample_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/haptics/milling_tool.h"

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

double min_angle_deg(const std::vector<Vec3>& vertices) {
  double min_deg = 180;
  for (std::size_t a = 0; a < vertices.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double cosine = vertices[a].normalized().dot(vertices[b].normalized());
      min_deg = std::min(min_deg, std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi);
    }
  }
  return min_deg;
}

TEST(SphereVertices, ReachTheTammesOptimumFor24Points) {
  const auto vertices = sphere_vertices(kTool, 24);
  for (const Vec3& vertex : vertices) EXPECT_NEAR(vertex.norm(), 1.5, 1e-12);
  EXPECT_NEAR(min_angle_deg(vertices), 43.6908, 1e-4);  // the published answer of Tammes' problem for 24
  const auto snub_cube = sphere_vertices(kTool);
  EXPECT_TRUE(std::equal(vertices.begin(), vertices.end(), snub_cube.begin(), snub_cube.end()));
}

// Platonic solids with triangular faces are the known solutions of Thomson's problem for their numbers of
// points.
TEST(SphereVertices, SpreadEvenlyForOtherCounts) {
  EXPECT_NEAR(min_angle_deg(sphere_vertices(kTool, 4)), 109.4712, 0.01);
  EXPECT_NEAR(min_angle_deg(sphere_vertices(kTool, 6)), 90, 0.1);
  EXPECT_NEAR(min_angle_deg(sphere_vertices(kTool, 12)), 63.4349, 0.5);
  for (const int count : {5, 8, 16, 20, 23, 32, 48, 96, 200}) {
    const auto vertices = sphere_vertices(kTool, count);
    ASSERT_EQ(vertices.size(), static_cast<std::size_t>(count));
    Vec3 sum = Vec3::Zero();
    for (const Vec3& vertex : vertices) {
      EXPECT_NEAR(vertex.norm(), 1.5, 1e-12);
      sum += vertex;
    }
    EXPECT_LT(sum.norm() / count, 0.005) << count;
    // The upper bound on the smallest angle between the points (Fejes Toth).
    const double area = std::numbers::pi / 6 * count / (count - 2);
    const double max_deg = std::acos(0.5 * (1 / std::pow(std::sin(area), 2) - 2)) * 180 / std::numbers::pi;
    EXPECT_GT(min_angle_deg(vertices), 0.85 * max_deg) << count;
  }
  EXPECT_THROW(sphere_vertices(kTool, 0), std::invalid_argument);
}

// Balanced: the first and second moments favour no direction.
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

TEST(SliceVertices, MatchTheRequestedCountAndRefuseZero) {
  const ShaftSlice slice = slice_vertices(kTool, 20, 5).front();
  ASSERT_EQ(slice.vertices_T.size(), 5u);
  const double side_mm = (slice.vertices_T[1] - slice.vertices_T[0]).norm();
  EXPECT_NEAR(side_mm, 2 * std::sin(std::numbers::pi / 5), 1e-12);
  EXPECT_NEAR((slice.vertices_T[0] - slice.vertices_T[4]).norm(), side_mm, 1e-12);
  EXPECT_THROW(slice_vertices(kTool, 20, 0), std::invalid_argument);
}

TEST(SliceVertices, AreCentredOnSegmentsOfEqualLength) {
  const auto slices = slice_vertices(kTool, 20);
  const double start = std::sqrt(1.5 * 1.5 - 1.0);
  const double share = (25 - start) / 20;
  EXPECT_NEAR(slices.front().centre_T.z(), start + 0.5 * share, 1e-12);
  EXPECT_NEAR(slices.back().centre_T.z(), 25 - 0.5 * share, 1e-12);
}

TEST(SliceVertices, AreEmptyIfTheShaftLiesInsideTheBurr) {
  EXPECT_TRUE(slice_vertices({1.5, 1.0, 1.0}, 20).empty());
  EXPECT_EQ(shaft_start_mm({1.0, 2.0, 10}), 0);
  EXPECT_THROW(slice_vertices(kTool, 0), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
