#include "osteomill/milling/no_go_watch.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;

constexpr double kRadius_mm = 1.5;

// Label 1 is allowed, 2 is not: a ball of 0.6 mm in the middle.
std::shared_ptr<const LabelMap> nerve_in_bone() {
  const GridGeometry grid = centred_cube(41, 0.25);
  std::vector<LabelMap::LabelIndex> places;
  for (int k = 0; k < 41; ++k) {
    for (int j = 0; j < 41; ++j) {
      for (int i = 0; i < 41; ++i)
        places.push_back(grid.world_from_voxel(VoxelIndex{i, j, k}).norm() < 0.6 ? 2 : 1);
    }
  }
  return std::make_shared<const LabelMap>(std::vector<Label>{{1, "bone", {}}, {2, "nerve", {}, true}}, grid,
                                          grid, places);
}

TEST(NoGoWatch, DetectsNoGoContactFromEveryDirection) {
  const NoGoWatch watch(nerve_in_bone(), kRadius_mm);
  for (int n = 0; n < 60; ++n) {
    const double z = 1 - (2 * n + 1) / 60.0, turn = 2.4 * n;
    const Vec3 from(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z);
    double touched_mm = -1;
    for (double distance_mm = 4; distance_mm > 0 && touched_mm < 0; distance_mm -= 0.02) {
      LabelTally tally;
      watch.tally_contacts(distance_mm * from, tally);
      const LabelCut cut = tally.take().front();
      if (cut.label == 0) continue;
      EXPECT_EQ(cut, (LabelCut{2, 0}));
      touched_mm = distance_mm;
    }
    // Tolerance: half a voxel diagonal plus the spacing of the sample points.
    EXPECT_NEAR(touched_mm, kRadius_mm + 0.6, 0.27) << from.transpose();
  }
}

TEST(NoGoWatch, ReportsNoContactWithoutLabelsOrForNanPosition) {
  LabelTally tally;
  NoGoWatch(nullptr, kRadius_mm).tally_contacts(Vec3::Zero(), tally);
  NoGoWatch(nerve_in_bone(), kRadius_mm).tally_contacts(Vec3::Constant(NAN), tally);
  EXPECT_EQ(tally.take(), LabelCuts{});
}

}  // namespace
}  // namespace osteomill
