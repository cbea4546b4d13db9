#include "osteomill/study/vertex_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

const std::vector<VertexSearchRow>& found() {
  static const std::vector<VertexSearchRow> rows = search_vertices();
  return rows;
}

const VertexSearchRow& row_of(const std::string& part, int vertices) {
  return *std::find_if(found().begin(), found().end(),
                       [&](const auto& row) { return row.part == part && row.vertices == vertices; });
}

TEST(VertexSearch, UnseenDepthMatchesGapBetweenVertices) {
  // Half the angle between two vertices of a circle, and the angle from a face of the octahedron to its
  // vertices.
  EXPECT_NEAR(row_of("circle", 8).unseen_worst, 1 - std::cos(std::numbers::pi / 8), 0.006);
  EXPECT_NEAR(row_of("circle", 4).unseen_worst, 1 - std::sqrt(0.5), 0.006);
  EXPECT_NEAR(row_of("sphere", 6).unseen_worst, 1 - std::sqrt(1.0 / 3), 0.01);
}

// On the circle, the springs of vertices at the angles a from the wall's normal add up to these sums.
TEST(VertexSearch, ForceDirectionErrorMatchesAnalyticSum) {
  double worst_deg = 0;
  for (int side = 0; side < 1000; ++side) {
    double along = 0, across = 0;
    for (int n = 0; n < 8; ++n) {
      const double a = 2 * std::numbers::pi * ((side + 0.5) / 1000 + n / 8.0);
      const double depth = std::cos(a) - 0.5;
      if (depth <= 0) continue;
      along += depth / (depth + 0.5) * std::cos(a);
      across += depth / (depth + 0.5) * std::sin(a);
    }
    worst_deg = std::max(worst_deg, std::abs(std::atan2(across, along)) * 180 / std::numbers::pi);
  }
  EXPECT_NEAR(row_of("circle", 8).direction_deg_worst, worst_deg, 0.2);
}

TEST(VertexSearch, ErrorsShrinkWithMoreVertices) {
  for (const auto& [part, few, many] : {std::tuple{"sphere", 6, 96}, std::tuple{"circle", 3, 32}}) {
    const VertexSearchRow& coarse = row_of(part, few);
    const VertexSearchRow& fine = row_of(part, many);
    EXPECT_FALSE(coarse.suffices);
    EXPECT_TRUE(fine.suffices);
    EXPECT_LT(fine.direction_deg_worst, 0.3 * coarse.direction_deg_worst);
    EXPECT_LT(fine.size_off_worst, 0.3 * coarse.size_off_worst);
    EXPECT_LT(fine.unseen_worst, 0.3 * coarse.unseen_worst);
  }
}

TEST(VertexSearch, LeastVerticesIsSmallestCountFromWhichAllSuffice) {
  std::vector<VertexSearchRow> rows;
  for (const auto& [part, vertices, suffices] : {std::tuple{"sphere", 6, true},
                                                 {"sphere", 8, false},
                                                 {"sphere", 12, true},
                                                 {"sphere", 16, true},
                                                 {"circle", 3, true},
                                                 {"circle", 4, false}}) {
    rows.push_back({.part = part, .vertices = vertices, .suffices = suffices});
  }
  EXPECT_EQ(least_vertices(rows, "sphere"), 12);
  EXPECT_EQ(least_vertices(rows, "circle"), 0);
}

}  // namespace
}  // namespace osteomill
