#include "osteomill/ct/scan_summary.h"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace osteomill {
namespace {

Scan some_scan() {
  GridGeometry geometry;
  geometry.dims = {3, 1, 2};
  geometry.spacing_mm = Vec3(0.5, 0.25, 2);
  geometry.origin_mm = Vec3(-1, 2, 3);
  geometry.direction << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return {DensityGrid(geometry, std::vector<float>{-5, 0, 10, 20, 30, 35}),
          "some.nrrd",
          "NRRD",
          {"one \xFF thing"}};
}

TEST(ScanSummary, JsonHasTheExpectedKeysAndValues) {
  const nlohmann::json json =
      nlohmann::json::parse(to_json(summarise(some_scan(), {10.0, "halfway", {{12, 3, 25}}}, 20.0)));
  EXPECT_EQ(json["dims"], nlohmann::json({3, 1, 2}));
  EXPECT_EQ(json["spacing_mm"], nlohmann::json({0.5, 0.25, 2.0}));
  EXPECT_EQ(json["origin_mm"], nlohmann::json({-1.0, 2.0, 3.0}));
  EXPECT_EQ(json["direction"], nlohmann::json({{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}));
  EXPECT_EQ(json["value_min"], -5);
  EXPECT_EQ(json["value_max"], 35);
  EXPECT_EQ(json["value_mean"], 15);
  EXPECT_EQ(json["suggested_iso"], 10);
  EXPECT_EQ(json["suggested_how"], "halfway");
  EXPECT_EQ(json["voxels_above_iso"], 2);
  EXPECT_EQ(json["warnings"].size(), 1U);
  EXPECT_EQ(json["boundaries"], nlohmann::json::parse(R"([{"density": 12, "below": 3, "above": 25}])"));
  EXPECT_EQ(json.size(), 12U);
}

TEST(ScanSummary, CountsVoxelsWithoutDensityButIgnoresThemOtherwise) {
  Scan scan = some_scan();
  const float none = std::numeric_limits<float>::quiet_NaN();
  scan.grid = DensityGrid(scan.grid.geometry(), {-5, none, 10, none, 30, 35});
  const ScanSummary summary = summarise(std::move(scan), {-7.0, "below all"}, -7.0);
  EXPECT_EQ(summary.value_mean, 17.5);
  EXPECT_EQ(summary.value_min, -5);
  EXPECT_EQ(summary.voxels_above_iso, 4U);
  EXPECT_EQ(nlohmann::json::parse(to_json(summary))["voxels_without_density"], 2);
  EXPECT_NE(to_text(summary).find("no density  2 voxels"), std::string::npos);
}

TEST(ScanSummary, TextStatesTheSummaryValues) {
  const std::string text =
      to_text(summarise(some_scan(), {10.0, "halfway", {{12, 3, 25, true}, {30, 25, 35}}}, 20.0));
  for (const char* part :
       {"some.nrrd (NRRD)", "3 x 1 x 2", "0.5 x 0.25 x 2 mm", "-5 to 35, mean 15", "10 suggested, halfway",
        "12, with 3 below and 25 above; the suggested isovalue lies on this boundary, sharpest at 12\n",
        "30, with 25 below and 35 above\n", "2 voxels above 20", "warning: one", "j runs along 0, 0, 1"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
}

}  // namespace
}  // namespace osteomill
