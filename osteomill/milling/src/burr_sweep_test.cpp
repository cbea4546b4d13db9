// Compares the bone cut by a burr along a path with its swept volume.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "osteomill/milling/burr_mill.h"
#include "osteomill/volume/sampling.h"

#include "tests/shapes.h"
#include "tests/swept_path.h"

namespace osteomill {
namespace {

using testing_support::Carving;
using testing_support::carving;
using testing_support::SweptPath;

constexpr BoneDensities kBone{0, 1000};
constexpr double kEdge_mm = 0.3;
const MillingSettings kMilling{.removal_rate_mm3_per_Ns = 1.5};

using Shape = std::function<double(const Vec3&)>;

// Path of a burr through bone: from `start` by `length_mm` along `ahead`, pressed in that direction.
struct Drive {
  const char* name;
  Shape bone;
  Vec3 start, ahead;
  double length_mm;
};

double floor_at_0(const Vec3& p) {
  return p.z();
}

Drive plunge(double radius_mm, double depth_mm) {
  return {"plunge", floor_at_0, radius_mm * Vec3::UnitZ(), -Vec3::UnitZ(), depth_mm};
}
// Two thirds of the ball in a block, entered from the side.
Drive groove(double radius_mm, double length_mm) {
  return {"groove", [](const Vec3& p) { return std::max(p.z(), -p.x()); },
          Vec3(-radius_mm, 0, -radius_mm / 3), Vec3::UnitX(), length_mm};
}
Drive diagonal(double radius_mm, double length_mm) {
  const Vec3 ahead = Vec3(1, 0.4, -1).normalized();
  return {"diagonal", floor_at_0, -radius_mm / -ahead.z() * ahead, ahead, length_mm};
}
// Down into a floor, along a wall that the burr just touches.
Drive along_wall(double radius_mm, double depth_mm) {
  return {"along a wall", [=](const Vec3& p) { return std::min(p.z(), radius_mm - p.x()); },
          radius_mm * Vec3::UnitZ(), -Vec3::UnitZ(), depth_mm};
}

// Returns a grid that contains the whole drive, its axes rotated by `turn` from W.
GridGeometry grid_about(const Drive& drive, double radius_mm, const Vec3& spacing_mm, const Quat& turn) {
  const Vec3 end = drive.start + drive.length_mm * drive.ahead;
  const double half = 0.5 * drive.length_mm + radius_mm + 1;
  Vec3 room = 0.5 * (end - drive.start).cwiseAbs() + Vec3::Constant(radius_mm + 1);
  if (!turn.isApprox(Quat::Identity())) room = Vec3::Constant(half);
  GridGeometry grid;
  grid.spacing_mm = spacing_mm;
  grid.direction = turn.toRotationMatrix();
  Vec3 last;
  for (int axis = 0; axis < 3; ++axis) {
    const int count = static_cast<int>(std::ceil(2 * room[axis] / spacing_mm[axis]));
    grid.dims[static_cast<std::size_t>(axis)] = count;
    last[axis] = (count - 1) * spacing_mm[axis];
  }
  // Offset from the voxel planes, so that nothing coincides with them by chance.
  grid.origin_mm = 0.5 * (drive.start + end) - grid.direction * (0.5 * last + Vec3(0.011, 0.017, 0.013));
  return grid;
}

struct Cut {
  Carving carving;
  double paid_mm3 = 0;
  double removed_mm3 = 0;
};

// Advances the burr as far as the bone ahead permits, as a following hand would.
Cut drive_through(Volume& volume, BurrMill& mill, const Drive& drive, double radius_mm, double force_N,
                  double dt_s = 1e-3) {
  const Volume before = volume;
  Cut cut;
  std::vector<Vec3> path;
  Vec3 centre = drive.start;
  for (int n = 0; n < 20000 && (centre - drive.start).norm() < drive.length_mm; ++n) {
    const std::optional<Vec3> surface =
        first_crossing(volume, centre, centre + (radius_mm + 0.5) * drive.ahead);
    const double gap_mm = surface ? (*surface - centre).norm() - radius_mm : 0.5;
    centre += std::clamp(gap_mm, 0.0, 0.02) * drive.ahead;
    path.push_back(centre);
    const double removed_mm3 = mill.step(centre, force_N * drive.ahead, dt_s).removed_mm3;
    cut.removed_mm3 += removed_mm3;
    cut.paid_mm3 += kMilling.removal_rate_mm3_per_Ns * force_N * dt_s;
    EXPECT_LE(cut.removed_mm3, cut.paid_mm3 * (1 + 1e-5)) << drive.name << ": never more than paid for";
  }
  const double spacing_mm = volume.geometry().spacing_mm.minCoeff();
  cut.carving = carving(before, volume, SweptPath(path, radius_mm, spacing_mm / std::ceil(spacing_mm / 0.1)));
  return cut;
}

Cut cut_in(const Drive& drive, double radius_mm, const Vec3& spacing_mm, double force_N,
           const Quat& turn = Quat::Identity()) {
  const GridGeometry grid = grid_about(drive, radius_mm, spacing_mm, turn);
  Volume volume = testing_support::shape_volume(grid, drive.bone, kEdge_mm / spacing_mm.minCoeff());
  BurrMill mill(volume, radius_mm, kBone, kMilling);
  return drive_through(volume, mill, drive, radius_mm, force_N);
}

void expect_swept(const Cut& cut, const Vec3& spacing_mm, const std::string& what) {
  EXPECT_NEAR(cut.carving.share(), 1, 0.02) << what;
  EXPECT_LE(cut.carving.left_mm, 0.5 * spacing_mm.maxCoeff()) << what;
  EXPECT_LE(cut.carving.lost_mm, std::min(0.25 * spacing_mm.maxCoeff(), 0.03)) << what;
  EXPECT_NEAR(cut.removed_mm3 / cut.paid_mm3, 1, 0.01) << what;
}

TEST(BurrSweep, CutMatchesTheSweptVolume) {
  constexpr double kRadius_mm = 1.5;
  for (const double spacing_mm : {0.2, 0.125}) {
    for (const Drive& drive : {plunge(kRadius_mm, 2.5), groove(kRadius_mm, 2), diagonal(kRadius_mm, 2.5),
                               along_wall(kRadius_mm, 2)}) {
      const Vec3 spacing = Vec3::Constant(spacing_mm);
      expect_swept(cut_in(drive, kRadius_mm, spacing, 3), spacing,
                   std::string(drive.name) + " at " + std::to_string(spacing_mm));
    }
  }
}

TEST(BurrSweep, CutMatchesTheSweptVolumeInARotatedGrid) {
  const Quat turn = Quat(0.8, 0.3, -0.4, 0.33).normalized();
  const Vec3 spacing = Vec3::Constant(0.2);
  for (const Drive& drive : {plunge(1.5, 2), diagonal(1.5, 2)}) {
    expect_swept(cut_in(drive, 1.5, spacing, 3, turn), spacing, drive.name);
  }
}

TEST(BurrSweep, CutMatchesTheSweptVolumeInAnisotropicVoxels) {
  const Vec3 spacing(0.3, 0.3, 0.7);
  for (const Drive& drive : {plunge(1.5, 3), groove(1.5, 3), diagonal(1.5, 3)}) {
    const Cut cut = cut_in(drive, 1.5, spacing, 3);
    EXPECT_NEAR(cut.carving.share(), 1, 0.03) << drive.name;
    EXPECT_LE(cut.carving.left_mm, 0.35) << drive.name;
    EXPECT_LE(cut.carving.lost_mm, 0.05) << drive.name;
    EXPECT_NEAR(cut.removed_mm3 / cut.paid_mm3, 1, 0.01) << drive.name;
  }
}

TEST(BurrSweep, CutMatchesTheSweptVolumeForBurrSizesAndForces) {
  struct Case {
    double radius_mm, spacing_mm, force_N;
  };
  for (const Case& c : {Case{0.5, 0.1, 0.5}, {3, 0.25, 9}, {1.5, 0.2, 0.5}, {1.5, 0.2, 9}}) {
    const Vec3 spacing = Vec3::Constant(c.spacing_mm);
    expect_swept(cut_in(plunge(c.radius_mm, 1), c.radius_mm, spacing, c.force_N), spacing,
                 std::to_string(c.radius_mm) + " mm, " + std::to_string(c.force_N) + " N");
  }
}

// In fine voxels lines take turns; none may be left uncut.
TEST(BurrSweep, LeavesNoIslandsInFineVoxels) {
  const Vec3 spacing = Vec3::Constant(0.03125);
  for (const double force_N : {1.5, 9.0}) {
    expect_swept(cut_in(plunge(1.0, 0.8), 1.0, spacing, force_N), spacing, std::to_string(force_N) + " N");
  }
}

TEST(BurrSweep, SlidingPastAWallChangesNoneOfItsVoxels) {
  constexpr double kRadius_mm = 1.5, kGap_mm = 0.2;
  const Vec3 spacing = Vec3::Constant(0.125);
  const Drive drive = along_wall(kRadius_mm + kGap_mm, 2);
  const GridGeometry grid = grid_about(drive, kRadius_mm + kGap_mm, spacing, Quat::Identity());
  Volume volume = testing_support::shape_volume(grid, drive.bone, kEdge_mm / spacing.x());
  const Volume before = volume;
  BurrMill mill(volume, kRadius_mm, kBone, kMilling);
  drive_through(volume, mill, drive, kRadius_mm, 3);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const VoxelIndex v{i, j, k};
        const Vec3 at = grid.world_from_voxel(v);
        // Only voxels outside the ball's path and above the floor that it cuts.
        if (at.z() < 0.6 || at.x() < kRadius_mm + 0.125) continue;
        ASSERT_EQ(volume.grid()[v], before.grid()[v]) << at.transpose();
      }
}

// After cutting to a surface, the same ball lowers nothing.
TEST(BurrSweep, CuttingAgainChangesNothing) {
  const GridGeometry grid = grid_about(plunge(1.5, 2), 1.5, Vec3::Constant(0.2), Quat::Identity());
  Volume volume = testing_support::shape_volume(grid, floor_at_0, kEdge_mm / 0.2);
  BurrReach reach(volume, 2.5, 0);
  CutVoxels voxels(grid, reach.max_voxels(), reach.max_pieces());
  const CuttingBall ball{grid.direction.transpose() * (Vec3(0.1, 0.05, 0.7) - grid.origin_mm),
                         Vec3(0.3, -0.2, -0.9).normalized(), 1.5};
  const CutProfile profile = CutProfile::between(0, 500, 1000);
  const auto cut = [&] {
    reach.find(ball.centre_mm, 2.2);
    voxels.gather(reach, ball, profile, 0.1);
    const double dropped = voxels.find_lowered(0.1, {});
    for (const CutVoxels::Row& row : voxels.rows()) {
      volume.lower_row(row.j, row.k, voxels.columns() + row.begin, voxels.after() + row.begin,
                       row.end - row.begin);
    }
    return dropped;
  };
  EXPECT_GT(cut(), 1000);
  EXPECT_EQ(cut(), 0);
}

// A tool that starts inside bone overlaps more than it can pay for, and its force rotates.
TEST(BurrSweep, RemovesItsBudgetWhenStartedInsideSolidBone) {
  const GridGeometry grid = grid_about(plunge(1, 1), 1, Vec3::Constant(0.125), Quat::Identity());
  Volume volume(DensityGrid(grid, std::vector<float>(grid.voxel_count(), 1000.0f)), 500);
  BurrMill mill(volume, 1, kBone, kMilling);
  double removed_mm3 = 0;
  const Vec3 middle = grid.world_from_voxel(Vec3(0.5 * grid.dims[0], 0.5 * grid.dims[1], 0.5 * grid.dims[2]));
  for (int n = 0; n < 500; ++n) {
    const Vec3 force(std::sin(0.1 * n), std::cos(0.1 * n), std::sin(0.03 * n));
    removed_mm3 += mill.step(middle, force.normalized(), 1e-3).removed_mm3;
    ASSERT_LE(removed_mm3, 1.5e-3 * (n + 1) * (1 + 1e-5));
  }
  EXPECT_NEAR(removed_mm3, 0.75, 0.01);
}

}  // namespace
}  // namespace osteomill
