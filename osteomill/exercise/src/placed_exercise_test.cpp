#include "osteomill/exercise/placed_exercise.h"

#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/exercise/region_voxels.h"
#include "osteomill/exercise/src/exercise_samples.h"
#include "osteomill/recording/replay_recording.h"

namespace osteomill {
namespace {

using namespace testing_support;

double volume_mm3(const Volume& bone, const VoxelSet& voxels) {
  return static_cast<double>(voxels.count()) * bone.geometry().voxel_volume_mm3();
}

std::string refusal(const Exercise& exercise, const Volume& bone) {
  try {
    place_exercise(exercise, bone);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PlaceExercise, TargetContainsBoneButNotTheAirAboveIt) {
  const Volume bone = bone_below_zero(0.25);
  const CylinderShape cylinder{{0.1, 0.2, 3}, {0.1, 0.2, -3}, 2};
  const PlacedExercise placed = place_exercise(exercise_with_target(region_of({cylinder})), bone);
  EXPECT_NEAR(volume_mm3(bone, placed.target), std::numbers::pi * 4 * 3, 0.02 * std::numbers::pi * 12);
}

TEST(PlaceExercise, FacesOutOfTheSurfaceNotIntoAnAdjacentFissure) {
  // A slit of 1 mm, 6 mm deep, next to which the target has much more wall than surface.
  const auto below = plane(Vec3::Zero(), Vec3::UnitZ());
  const Volume bone = shape_volume(centred_cube(64, 0.25), [&](const Vec3& p) {
    return std::max(below(p), std::min({0.5 - std::abs(p.y()), p.z() + 6}));
  });
  const PlacedExercise placed =
      place_exercise(exercise_with_target(region_of({BoxShape{{-3, -5, -3}, {3, -0.5, 0}}})), bone);
  EXPECT_EQ(placed.outward_W, Vec3::UnitZ());
}

TEST(PlaceExercise, FacesOutOfTheBoneAndLabelsTargetAndStructures) {
  const Volume bone = bone_below_zero(0.25);
  Exercise exercise = exercise_with_target(region_of({BoxShape{{-2, -2, -2}, {2, 2, 0}}}));
  exercise.no_go.push_back({"nerve", region_of({BoxShape{{-2, -2, -6}, {2, 2, -5}}}), 3});
  const PlacedExercise placed = place_exercise(exercise, bone);
  EXPECT_TRUE(placed.outward_W.isApprox(Vec3::UnitZ(), 1e-9));
  const std::shared_ptr<const LabelMap> colours = colours_of(placed);
  const auto name_at = [&](const Vec3& point_W) {
    const LabelMap::LabelIndex label = colours->nearest_to(point_W);
    return label == 0 ? "" : colours->label(label).name;
  };
  EXPECT_EQ(name_at({0, 0, -1}), "target");
  EXPECT_EQ(name_at({0, 0, -5.5}), "nerve");
  EXPECT_EQ(name_at({0, 0, -3}), "");
}

TEST(PlaceExercise, GuardsStructuresAndReplayFailsWithoutThem) {
  Volume bone = bone_below_zero(0.25);
  const Volume plain = bone;
  Exercise exercise = exercise_with_target(region_of({BoxShape{{3, 3, -2}, {5, 5, 0}}}));
  exercise.no_go.push_back({"nerve", region_of({SphereShape{{0, 0, -1.5}, 0.5}}), 3, 0.5});
  bone.set_no_go(place_exercise(exercise, bone).distances);
  const Recording recording = record_poses(bone, way({0, 0, 2}, {0, 0, -2}, 0.004), 1);
  EXPECT_NEAR(recording.records.back().no_go_distance_mm, 0.5, 0.05);
  EXPECT_GT(recording.records.back().wrench.force_N.z(), 2);
  EXPECT_FALSE(verify_recording(bone, recording, {}).difference);
  try {
    verify_recording(plain, recording, {});
    FAIL() << "it replays without its structures";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("with 1 guarded structures"), std::string::npos);
  }
}

TEST(PlaceExercise, AllowsTheMarginAroundTheTargetAndNothingBeyond) {
  const Volume bone = bone_below_zero(0.25);
  Exercise exercise = exercise_with_target(region_of({BoxShape{{-2, -2, -2.5}, {2, 2, 0}}}));
  exercise.margin_mm = 0.5;
  const PlacedExercise placed = place_exercise(exercise, bone);
  const auto is_outside = [&](const Vec3& point_W) {
    const Vec3 v = bone.geometry().voxel_from_world(point_W).array().round();
    return placed.is_outside({static_cast<int>(v.x()), static_cast<int>(v.y()), static_cast<int>(v.z())});
  };
  EXPECT_FALSE(is_outside({0, 0, -1}));
  EXPECT_FALSE(is_outside({2.3, 0, -1}));
  EXPECT_TRUE(is_outside({2.9, 0, -1}));
  EXPECT_FALSE(is_outside({0, 0, -2.8}));
  EXPECT_TRUE(is_outside({0, 0, -3.4}));
}

TEST(PlaceExercise, IntersectsTheShapesOfARegion) {
  const Volume bone = bone_below_zero(0.25);
  const Region region = region_of({ShellShape{1.5}, BoxShape{{-2, -2, -6}, {2, 2, 6}}});
  const PlacedExercise placed = place_exercise(exercise_with_target(region), bone);
  // 4 mm by 4 mm by 1.5 mm: 16 voxels by 16 by 6.
  EXPECT_EQ(placed.target.count(), 16u * 16u * 6u);
}

TEST(PlaceExercise, ShellRegionIgnoresAnEnclosedCavity) {
  const Volume bone = shape_volume(centred_cube(60, 0.25),
                                   [](const Vec3& p) { return std::max(p.norm() - 6, 2 - p.norm()); });
  const Region layer = region_of({ShellShape{1}});
  const double expected_mm3 = 4 * std::numbers::pi / 3 * (216 - 125);
  EXPECT_NEAR(volume_mm3(bone, region_voxels(layer, bone, "task.toml")), expected_mm3, 0.03 * expected_mm3);
}

TEST(PlaceExercise, MeasuresTheDistanceFromTargetToStructure) {
  const Volume bone = bone_below_zero(0.25);
  Exercise exercise = exercise_with_target(region_of({BoxShape{{-2, -2, -2}, {2, 2, 0}}}));
  exercise.no_go.push_back({"nerve", region_of({SphereShape{{0, 0, -6}, 1}}), 3});
  const PlacedExercise placed = place_exercise(exercise, bone);
  EXPECT_NEAR(placed.structures.front().from_target_mm, 3, 0.25);
  EXPECT_NEAR(no_go_distance_mm(*placed.distances, {0, 0, -2}, 0.5), 2.5, 1e-12);
}

TEST(PlaceExercise, RefusesRegionsThatDoNotFitTheScanAndNamesTheLine) {
  Volume bone = bone_below_zero(0.5);
  const auto with_target = [](Shape shape) { return exercise_with_target(region_of({std::move(shape)})); };
  EXPECT_EQ(refusal(with_target(BoxShape{{-1, -1, 2}, {1, 1, 3}}), bone),
            "task.toml: line 7: the target holds no bone");
  EXPECT_EQ(refusal(with_target(SphereShape{{0, 0, 60}, 2}), bone),
            "task.toml: line 7: the sphere lies outside the scan");
  EXPECT_EQ(refusal(with_target(LabelShape{"nerve"}), bone),
            "task.toml: line 7: there is no label map that has nerve");
  const VoxelIndex first{4, 4, 4};
  GridGeometry one = bone.geometry();
  one.dims = {1, 1, 1};
  one.origin_mm = bone.geometry().world_from_voxel(first);
  bone.set_labels(std::make_shared<LabelMap>(std::vector<Label>{{3, "Mandible", {}, false}}, bone.geometry(),
                                             one, std::vector<LabelMap::LabelIndex>{1}));
  EXPECT_EQ(refusal(with_target(LabelShape{"nerve"}), bone),
            "task.toml: line 7: nerve is not in the label map, which has Mandible");
  EXPECT_EQ(refusal(with_target(LabelShape{"mandible"}), bone), "");
  EXPECT_EQ(refusal(with_target(LabelShape{"3"}), bone), "");

  Exercise overlapping = with_target(BoxShape{{-2, -2, -4}, {2, 2, 0}});
  overlapping.no_go.push_back({"nerve", region_of({SphereShape{{0, 0, -4}, 1}}), 3});
  EXPECT_NE(refusal(overlapping, bone).find("line 7: the target overlaps nerve, which must not be touched"),
            std::string::npos);
}

}  // namespace
}  // namespace osteomill
