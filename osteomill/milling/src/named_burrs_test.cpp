#include "osteomill/milling/named_burrs.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(NamedBurrs, AreFoundByNameAndBySize) {
  std::set<std::string> names;
  for (const NamedBurr& burr : named_burrs()) {
    EXPECT_EQ(find_burr(burr.name), &burr);
    EXPECT_EQ(find_burr(burr.tool, burr.edge), &burr) << burr.name;
    EXPECT_TRUE(names.insert(burr.name).second) << burr.name;
    EXPECT_LT(burr.tool.shaft_radius_mm, burr.tool.burr_radius_mm) << burr.name;
    // The name ends with the diameter, in mm or in tenths of a mm.
    const std::string name(burr.name);
    const double size = std::stod(name.substr(name.rfind('-') + 1));
    EXPECT_NEAR(2 * burr.tool.burr_radius_mm, name.starts_with("dental") ? 0.1 * size : size, 1e-12) << name;
    EXPECT_EQ(burr.edge == BurrEdge::diamond, name.find("diamond") != std::string::npos) << name;
  }
  EXPECT_EQ(find_burr("cutting-7"), nullptr);
  EXPECT_EQ(find_burr(MillingTool{1.5, 0.1, 25}, BurrEdge::cutting), nullptr);
}

TEST(NamedBurrs, CoverHalfToSixMillimetreDiametersForEachEdge) {
  for (const BurrEdge edge : {BurrEdge::cutting, BurrEdge::diamond}) {
    double least_mm = 100, greatest_mm = 0;
    for (const NamedBurr& burr : named_burrs()) {
      if (burr.edge != edge) continue;
      least_mm = std::min(least_mm, 2 * burr.tool.burr_radius_mm);
      greatest_mm = std::max(greatest_mm, 2 * burr.tool.burr_radius_mm);
    }
    EXPECT_EQ(least_mm, 0.5);
    EXPECT_EQ(greatest_mm, 6);
  }
}

}  // namespace
}  // namespace osteomill
