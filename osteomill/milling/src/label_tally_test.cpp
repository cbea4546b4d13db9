#include "osteomill/milling/label_tally.h"

#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "osteomill/milling/burr_mill.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;

TEST(LabelTally, ReportsAllLabelsAndTheirTotalRemovedVolume) {
  LabelTally tally;
  std::map<int, double> told;
  double added = 0;
  for (int tick = 0; tick < 50; ++tick) {
    for (int label = 0; label < 9 && tick < 40; ++label) {
      const double removed_mm3 = 0.25 * label + tick;
      tally.add(static_cast<LabelMap::LabelIndex>(label), removed_mm3);
      if (label > 0) added += removed_mm3;
    }
    bool ended = false;
    for (const LabelCut& cut : tally.take()) {
      EXPECT_FALSE(ended && cut.label != 0) << "an entry behind an empty one";
      ended = cut.label == 0;
      if (!ended) told[cut.label] += cut.removed_mm3;
    }
  }
  EXPECT_EQ(tally.take(), LabelCuts{});
  ASSERT_EQ(told.size(), 8u);
  double sum = 0;
  for (const auto& [label, removed_mm3] : told) sum += removed_mm3;
  EXPECT_DOUBLE_EQ(sum, added);
}

// Returns the volume of the part above a plane at height z of a ball of this radius about the origin.
double cap_mm3(double radius_mm, double z) {
  const double h = radius_mm - z;
  return std::numbers::pi * h * h * (3 * radius_mm - h) / 3;
}

// A burr inside solid bone cuts its ball plus a disc whose thickness is its advance. A plane at z = 0.4 mm
// divides both as geometry predicts.
TEST(BurrMill, SplitsRemovedVolumeAmongLabelsByGeometry) {
  constexpr double kRadius_mm = 1.5, kPlane_mm = 0.4;
  const GridGeometry grid = centred_cube(61, 0.1);
  std::vector<LabelMap::LabelIndex> places;
  for (int k = 0; k < 61; ++k) {
    const double z = grid.world_from_voxel(VoxelIndex{0, 0, k}).z();
    places.insert(places.end(), 61 * 61, z > kPlane_mm + 0.05 ? 2 : z > -0.1 ? 0 : 1);
  }
  Volume bone(DensityGrid(grid, std::vector<float>(grid.voxel_count(), 1000.0f)), 500);
  bone.set_labels(std::make_shared<const LabelMap>(std::vector<Label>{{1, "below", {}}, {2, "above", {}}},
                                                   grid, grid, places));
  BurrMill mill(bone, kRadius_mm, {0, 1000}, {.removal_rate_mm3_per_Ns = 2.0});
  double removed_mm3 = 0;
  std::array<double, 3> of_label_mm3{};
  for (int n = 0; n < 500; ++n) {
    removed_mm3 += mill.step(Vec3::Zero(), {50, 0, 0}, 1e-3).removed_mm3;
    for (const LabelCut& cut : mill.by_label().take()) of_label_mm3[cut.label] += cut.removed_mm3;
  }
  const double ball_mm3 = 4 * std::numbers::pi * std::pow(kRadius_mm, 3) / 3;
  const double disc_mm2 = std::numbers::pi * kRadius_mm * kRadius_mm;
  const double ahead_mm = (removed_mm3 - ball_mm3) / disc_mm2;
  // Maximum advance: 0.12 mm plus half a voxel.
  EXPECT_NEAR(ahead_mm, 0.17, 0.03);
  const auto above_mm3 = [&](double z) {
    const double segment_mm2 =
        kRadius_mm * kRadius_mm * std::acos(z / kRadius_mm) - z * std::sqrt(kRadius_mm * kRadius_mm - z * z);
    return cap_mm3(kRadius_mm, z) + ahead_mm * segment_mm2;
  };
  // The planes between voxels: 0.45 and -0.15 mm.
  EXPECT_NEAR(of_label_mm3[2], above_mm3(0.45), 0.01 * above_mm3(0.45));
  const double below_mm3 = removed_mm3 - above_mm3(-0.15);
  EXPECT_NEAR(of_label_mm3[1], below_mm3, 0.01 * below_mm3);
  // Matches the voxels' loss exactly.
  std::array<double, 3> lost{};
  for (int k = 0; k < 61; ++k) {
    for (int j = 0; j < 61; ++j) {
      for (int i = 0; i < 61; ++i)
        lost[bone.labels()->at({i, j, k})] += (1000 - static_cast<double>(bone.grid()[{i, j, k}])) * 1e-6;
    }
  }
  EXPECT_NEAR(of_label_mm3[1], lost[1], 1e-9);
  EXPECT_NEAR(of_label_mm3[2], lost[2], 1e-9);
  EXPECT_NEAR(removed_mm3, lost[0] + lost[1] + lost[2], 1e-9);
}

}  // namespace
}  // namespace osteomill
