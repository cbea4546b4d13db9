#include "osteomill/study/probe.h"

#include <cmath>

#include <gtest/gtest.h>

#include "osteomill/study/probe_bones.h"

namespace osteomill {
namespace {

TEST(Probe, DefaultAlgorithmsTorqueIsLeverTimesForceForEveryTool) {
  for (const MillingTool& tool : {MillingTool{}, MillingTool{0.6, 0.4, 15}, MillingTool{3, 1.5, 40}}) {
    MillingSetup setup;
    setup.tool = tool;
    const Volume wall = flat_wall(tool), edge = sharp_edge(tool);
    const Probe right = probe(setup, wall, edge);
    EXPECT_LT(right.torque_error, 0.02) << tool.burr_radius_mm;
    EXPECT_GT(right.felt_N_per_mm, 0.5) << tool.burr_radius_mm;
    // Halving the setting halves the stiffness felt.
    setup.haptics.set_option("stiffness", 0.4);
    EXPECT_NEAR(probe(setup, wall, edge).felt_N_per_mm, 0.4, 0.04) << tool.burr_radius_mm;
  }
}

}  // namespace
}  // namespace osteomill
