#include "osteomill/exercise/measures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/row_major.h"
#include "osteomill/exercise/region_voxels.h"
#include "osteomill/exercise/src/exercise_samples.h"

namespace osteomill {
namespace {

using namespace testing_support;

double measured(const std::string& name, const Attempt& attempt) {
  const Measure* measure = find_measure(name);
  return measure == nullptr ? -1e9 : measure->value(attempt);
}

/// Removes the voxels from the bone at once, without a session.
Attempt attempt_removing(const PlacedExercise& placed, const Volume& scan, const Region& region) {
  Volume after = scan;
  region_voxels(region, scan, "task.toml").for_each([&](const VoxelIndex& v) { after.lower_density(v, 0); });
  VoxelSet removed = removed_voxels(scan, after);
  auto left = thickness_left(placed, scan, after, removed);
  return {&placed, &scan, std::move(after), std::move(removed), {}, {}, std::move(left), {}, {}};
}

class BoxMeasures : public ::testing::Test {
 protected:
  BoxMeasures() {
    exercise_.no_go.push_back({"nerve", region_of({BoxShape{{-7, -2, -7}, {7, 2, -6}}}), 3});
    exercise_.keep = region_of({BoxShape{{3, -3, -2}, {5, 3, 0}}});
    placed_ = place_exercise(exercise_, scan_);
  }
  Attempt removing(const BoxShape& box) const { return attempt_removing(placed_, scan_, region_of({box})); }
  /// Returns an attempt that removes nothing, with ticks of 1 ms.
  Attempt with_ticks(const std::vector<AttemptTick>& ticks) const {
    Attempt attempt = removing({{-1, -1, 5}, {1, 1, 6}});
    attempt.ticks = ticks;
    for (const AttemptTick& tick : ticks)
      attempt.distances_mm.push_back(no_go_distance_mm(*placed_.distances, tick.burr_W, tick.burr_radius_mm));
    return attempt;
  }

  Volume scan_ = bone_below_zero(0.25);
  Exercise exercise_ = exercise_with_target(region_of({BoxShape{{-2, -2, -4}, {2, 2, 0}}}));
  PlacedExercise placed_;
};

TEST_F(BoxMeasures, CountBoneRemovedInsideAndOutsideTheTarget) {
  // The target is 4 x 4 x 4 mm; this removes its upper half, and half as much next to it.
  const Attempt attempt = removing({{-2, -2, -2}, {4, 2, 0}});
  EXPECT_DOUBLE_EQ(measured("target_removed_percent", attempt), 50);
  EXPECT_DOUBLE_EQ(measured("removed_outside_mm3", attempt), 16);
  EXPECT_DOUBLE_EQ(measured("removed_outside_percent", attempt), 25);
  EXPECT_DOUBLE_EQ(measured("removed_mm3", attempt), 48);
  EXPECT_DOUBLE_EQ(measured("dice_percent", attempt), 200.0 * 32 / (64 + 48));
  EXPECT_DOUBLE_EQ(measured("keep_removed_mm3", attempt), 8);
  EXPECT_DOUBLE_EQ(measured("no_go_removed_mm3", attempt), 0);
}

TEST_F(BoxMeasures, ReportTheThicknessOfBoneLeftAboveAStructure) {
  // From z = -4.5 to the structure's top at -6.
  const Attempt attempt = removing({{-2, -2, -4.5}, {2, 2, 0}});
  EXPECT_NEAR(measured("thickness_left_min_mm", attempt), 1.5, 0.01);
  EXPECT_GE(measured("thickness_left_median_mm", attempt), 1.5);
  EXPECT_TRUE(std::isnan(measured("thickness_left_min_mm", removing({{-1, -1, 5}, {1, 1, 6}}))));
}

TEST_F(BoxMeasures, CountAndTimeContactsOfASpinningBurrWithAStructure) {
  // Moves down at 1 mm/s from z = -3: a burr of 1 mm reaches z = -6 after 2 s; then up again; twice.
  std::vector<AttemptTick> ticks;
  for (int pass = 0; pass < 2; ++pass) {
    for (int n = 0; n < 4000; ++n) {
      const double down_mm = n < 2100 ? 1e-3 * n : 2.1 - 1e-3 * (n - 2100);
      ticks.push_back({.time_s = 1e-3 * static_cast<double>(ticks.size()),
                       .dt_s = 1e-3,
                       .burr_W = {0, 0, -3 - down_mm},
                       .burr_radius_mm = 1,
                       .force_N = down_mm,
                       .spindle_on = true});
    }
  }
  const Attempt attempt = with_ticks(ticks);
  EXPECT_DOUBLE_EQ(measured("no_go_contacts", attempt), 2);
  EXPECT_NEAR(measured("no_go_first_contact_s", attempt), 2, 0.0011);
  EXPECT_NEAR(measured("no_go_contact_s", attempt), 0.4, 0.005);
  EXPECT_NEAR(measured("no_go_min_distance_mm", attempt), -0.1, 1e-9);
  EXPECT_NEAR(measured("no_go_force_max_N", attempt), 2.1, 1e-9);
  EXPECT_NEAR(measured("duration_s", attempt), 8, 1e-9);
  EXPECT_DOUBLE_EQ(measured("cutting_s", attempt), 0);
  EXPECT_TRUE(std::isnan(measured("force_median_N", attempt)));

  for (AttemptTick& tick : ticks) tick.spindle_on = false;
  EXPECT_DOUBLE_EQ(measured("no_go_contacts", with_ticks(ticks)), 0);
  EXPECT_TRUE(std::isnan(measured("no_go_first_contact_s", with_ticks(ticks))));
}

TEST_F(BoxMeasures, GroupForceAndRemovalRateByDistanceFromStructures) {
  std::vector<AttemptTick> ticks;
  const auto cut = [&](double z, double force_N, double removed_mm3, double radius_mm, int count) {
    for (int n = 0; n < count; ++n)
      ticks.push_back({.dt_s = 1e-3,
                       .burr_W = {0, 0, z},
                       .burr_radius_mm = radius_mm,
                       .force_N = force_N,
                       .removed_mm3 = removed_mm3,
                       .spindle_on = true});
  };
  cut(4, 3, 2e-3, 1.5, 90);
  cut(0.5, 2, 1e-3, 1, 6);
  cut(-3.5, 1, 0.5e-3, 0.5, 4);
  const Attempt attempt = with_ticks(ticks);
  EXPECT_DOUBLE_EQ(measured("force_median_N", attempt), 3);
  EXPECT_DOUBLE_EQ(measured("force_median_far_N", attempt), 3);
  EXPECT_DOUBLE_EQ(measured("force_median_middle_N", attempt), 2);
  EXPECT_DOUBLE_EQ(measured("force_median_near_N", attempt), 1);
  EXPECT_NEAR(measured("removal_rate_far_mm3_s", attempt), 2, 1e-12);
  EXPECT_NEAR(measured("removal_rate_near_mm3_s", attempt), 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(measured("burr_radius_median_near_mm", attempt), 0.5);
  EXPECT_DOUBLE_EQ(measured("burr_radius_median_far_mm", attempt), 1.5);
  EXPECT_NEAR(measured("cutting_s", attempt), 0.1, 1e-12);
}

TEST_F(BoxMeasures, AreNaNIfTheirInputIsMissing) {
  for (const char* name : {"hidden_cutting_percent", "view_changes", "step_s", "dice_peak_percent",
                           "taper_deg", "undercut_mm3", "reduction_median_mm"})
    EXPECT_TRUE(std::isnan(measured(name, with_ticks({})))) << name;
  Exercise without = exercise_;
  without.no_go.clear();
  without.keep.reset();
  const PlacedExercise placed = place_exercise(without, scan_);
  const Attempt attempt = attempt_removing(placed, scan_, region_of({BoxShape{{-1, -1, -1}, {1, 1, 0}}}));
  for (const char* name : {"no_go_contacts", "no_go_min_distance_mm", "no_go_removed_mm3", "keep_removed_mm3",
                           "thickness_left_min_mm"})
    EXPECT_TRUE(std::isnan(measured(name, attempt))) << name;
}

TEST_F(BoxMeasures, ReportARowPerItemAndPerStructure) {
  exercise_.items.push_back({"target_removed_percent", "", 40.0, std::nullopt, "a book, page 3", {}, 1});
  exercise_.items.push_back({"target_removed_percent", "", std::nullopt, 45.0, "", {}, 2});
  exercise_.items.push_back({"thickness_left_min_mm", "nerve", 1.0, std::nullopt, "", {}, 3});
  placed_ = place_exercise(exercise_, scan_);
  std::vector<std::string> limited;
  std::size_t of_nerve = 0;
  for (const MeasuredValue& row : measure_attempt(removing({{-2, -2, -2}, {2, 2, 0}}))) {
    if (row.measure.ends_with(".nerve")) ++of_nerve;
    if (row.limit.empty()) {
      EXPECT_FALSE(row.is_met);
      continue;
    }
    limited.push_back(row.measure + " " + row.limit +
                      (row.is_met ? *row.is_met ? " met " : " missed " : " - ") + row.source);
  }
  EXPECT_EQ(limited, (std::vector<std::string>{"target_removed_percent at least 40 met a book, page 3",
                                               "target_removed_percent at most 45 missed ",
                                               "thickness_left_min_mm.nerve at least 1 met "}));
  EXPECT_EQ(of_nerve, 9u);
}

TEST_F(BoxMeasures, TimeEachStepFromTheEndOfThePreviousOne) {
  exercise_.steps = {{"upper", region_of({BoxShape{{-2, -2, -2}, {2, 2, 0}}}), 50},
                     {"lower", region_of({BoxShape{{-2, -2, -4}, {2, 2, -2}}}), 100}};
  placed_ = place_exercise(exercise_, scan_);
  Attempt attempt = removing({{-2, -2, -4}, {3, 2, 0}});
  // Removed from the top at 1 mm/s, beginning at 1 s; next to the target at the end.
  attempt.removed.for_each([&](const VoxelIndex& v) {
    const Vec3 place_W = scan_.geometry().world_from_voxel(v);
    attempt.removal_times_s[row_major(scan_.geometry().dims, v.i, v.j, v.k)] =
        static_cast<float>(place_W.x() > 2 ? 9 : 1 - place_W.z());
  });
  for (int n = 0; n <= 1000; ++n) attempt.ticks.push_back({.time_s = 0.01 * n, .dt_s = 0.01});
  const Measure& step_s = *find_measure("step_s");
  // Half of the upper half is gone after 1 mm; the lower half, after 4 mm.
  EXPECT_NEAR(step_s.value_at(attempt, 0), 2, 0.15);
  EXPECT_NEAR(step_s.value_at(attempt, 1), 3, 0.15);
  EXPECT_NEAR(step_s.value(attempt), 5, 0.15);
  // The Dice coefficient peaks before bone is removed that should stay.
  EXPECT_DOUBLE_EQ(measured("dice_peak_percent", attempt), 100);
  EXPECT_NEAR(measured("dice_peak_s", attempt), 5, 0.15);
  EXPECT_DOUBLE_EQ(measured("dice_percent", attempt), 200.0 * 64 / (64 + 80));
  const std::vector<AttemptProgress> way = progress_of(attempt);
  EXPECT_NEAR(way[way.size() * 3 / 10].target_removed_percent, 50, 5);
  EXPECT_DOUBLE_EQ(way.back().removed_outside_mm3, 16);
}

TEST(Perforation, IsReportedForAThroughHoleButNotForABlindHole) {
  Volume scan = bone_below_zero(0.25);
  const auto hollow = [&](const BoxShape& box) {
    region_voxels(region_of({box}), scan, "task.toml").for_each([&](const VoxelIndex& v) {
      scan.lower_density(v, 0);
    });
  };
  hollow({{-3, -3, -5}, {3, 3, -4}});
  Exercise exercise = exercise_with_target(region_of({BoxShape{{-1, -1, -1}, {1, 1, 0}}}));
  exercise.no_go.push_back({"floor", region_of({BoxShape{{-3, -3, -4}, {3, 3, -2}}}), 1});
  const PlacedExercise placed = place_exercise(exercise, scan);
  const auto perforated = [&](const BoxShape& removed) {
    return measured("no_go_perforated", attempt_removing(placed, scan, region_of({removed})));
  };
  EXPECT_EQ(perforated({{-1, -1, -1}, {1, 1, 0}}), 0);
  EXPECT_EQ(perforated({{-1, -1, -3.8}, {1, 1, 0}}), 0);
  EXPECT_EQ(perforated({{-1, -1, -4}, {1, 1, 0}}), 1);
  // From the cavity upwards, and past it.
  EXPECT_EQ(perforated({{-1, -1, -4}, {1, 1, -2.3}}), 0);
  EXPECT_EQ(perforated({{4, -1, -5}, {5, 1, 0}}), 0);
}

ViewSample view_from(const Vec3& eye_W, const Vec3& towards_viewer_W) {
  ViewSample view;
  view.X_WC = {eye_W, Quat::FromTwoVectors(Vec3::UnitZ(), towards_viewer_W)};
  view.field_of_view_rad = 0.5;
  view.aspect = 1.5;
  return view;
}

TEST(IsHidden, ReturnsTrueForOccludedClippedOrOffscreenPoints) {
  Volume bone = bone_below_zero(0.25);
  region_voxels(region_of({BoxShape{{-2, -2, -5}, {2, 2, -4}}}), bone, "task.toml")
      .for_each([&](const VoxelIndex& v) { bone.lower_density(v, 0); });
  const ViewSample above = view_from({0, 0, 60}, Vec3::UnitZ());
  EXPECT_FALSE(is_hidden(above, bone, Vec3::Zero()));
  EXPECT_TRUE(is_hidden(view_from({0, 0, -60}, -Vec3::UnitZ()), bone, Vec3::Zero()));
  // The floor of the cavity is hidden from above too, until a cut removes its roof.
  const auto cut_above = [&](double z) {
    ViewSample view = above;
    view.cuts[1] = {-Vec3::UnitZ(), -z};
    return view;
  };
  EXPECT_TRUE(is_hidden(above, bone, {0, 0, -5}));
  EXPECT_TRUE(is_hidden(cut_above(-2), bone, {0, 0, -5}));
  EXPECT_FALSE(is_hidden(cut_above(-4.5), bone, {0, 0, -5}));
  EXPECT_TRUE(is_hidden(cut_above(-6), bone, {0, 0, -5})) << "it is cut away itself";
  // The picture extends to tan 0.25 of 60 mm vertically, and 1.5 times as far horizontally.
  EXPECT_FALSE(is_hidden(above, bone, {0, 15, 0.5}));
  EXPECT_TRUE(is_hidden(above, bone, {0, 16, 0.5}));
  EXPECT_FALSE(is_hidden(above, bone, {22, 0, 0.5}));
  EXPECT_TRUE(is_hidden(above, bone, {24, 0, 0.5}));
}

TEST(ViewChanges, CountMotionsThatBeginAfterARest) {
  EXPECT_TRUE(std::isnan(view_changes({})));
  std::vector<ViewSample> views;
  const auto add = [&](double seconds, double speed_mm_s) {
    for (int n = 0; n < 30 * seconds; ++n) {
      const Vec3 eye_W = views.empty() ? Vec3(0, 0, 60) : views.back().X_WC.position_mm;
      ViewSample view = view_from(eye_W + Vec3(speed_mm_s / 30, 0, 0), Vec3::UnitZ());
      view.time_s = static_cast<double>(views.size()) / 30;
      views.push_back(view);
    }
  };
  add(2, 0);
  EXPECT_EQ(view_changes(views), 0);
  add(1, 20);
  add(0.2, 0);
  add(1, -20);
  EXPECT_EQ(view_changes(views), 1) << "a short stop parts no two motions";
  add(1, 0);
  add(0.1, 20);
  EXPECT_EQ(view_changes(views), 2);
}

TEST(HiddenCutting, IsMeasuredFromTheRecordedViews) {
  const Volume bone = bone_below_zero(0.25, 10);
  std::vector<Vec3> places = way({0.03, 0.05, 1.6}, {0.03, 0.05, 0.4}, 0.004);
  places.resize(places.size() + 300, places.back());
  Recording recording = record_poses(bone, places, 1.5);
  const PlacedExercise placed =
      place_exercise(exercise_with_target(region_of({SphereShape{{0.03, 0.05, 0.4}, 1.5}})), bone);
  EXPECT_TRUE(std::isnan(measured("hidden_cutting_percent", make_attempt(placed, bone, recording))));
  // Seen from above in the first half, from below in the second.
  double cutting_s = 0;
  const std::vector<AttemptTick> ticks = attempt_ticks(recording);
  for (const AttemptTick& tick : ticks) cutting_s += tick.is_cutting() ? tick.dt_s : 0;
  double passed_s = 0, turn_s = 0;
  for (const AttemptTick& tick : ticks) {
    passed_s += tick.is_cutting() ? tick.dt_s : 0;
    if (passed_s < 0.5 * cutting_s) turn_s = tick.time_s;
  }
  for (double time_s = 0; time_s < ticks.back().time_s; time_s += 1.0 / 30) {
    recording.views.push_back(time_s < turn_s ? view_from({0, 0, 60}, Vec3::UnitZ())
                                              : view_from({0, 0, -60}, -Vec3::UnitZ()));
    recording.views.back().time_s = time_s;
  }
  const Attempt attempt = make_attempt(placed, bone, recording);
  EXPECT_NEAR(measured("hidden_cutting_percent", attempt), 50, 10);
  EXPECT_EQ(measured("view_changes", attempt), 1);
  // Every removed voxel has a time, and the deepest is the last.
  EXPECT_EQ(attempt.removal_times_s.size(), attempt.removed.count());
}

TEST(Strokes, EndWhereTheirDirectionReverses) {
  // Five strokes of 6 mm back and forth at 20 mm/s, with a shake of 0.05 mm.
  std::vector<AttemptTick> ticks;
  for (int stroke = 0; stroke < 5; ++stroke) {
    for (int n = 0; n < 300; ++n) {
      const double along_mm = stroke % 2 == 0 ? 0.02 * n : 6 - 0.02 * n;
      ticks.push_back({.dt_s = 1e-3, .burr_W = {along_mm, n % 2 * 0.05, 0}, .removed_mm3 = 1e-3});
    }
  }
  const std::vector<Stroke> strokes = strokes_of(ticks);
  ASSERT_EQ(strokes.size(), 5u);
  for (const Stroke& stroke : strokes) {
    EXPECT_NEAR(stroke.length_mm, 6, 0.1);
    EXPECT_NEAR(stroke.duration_s, 0.3, 0.03);
  }
}

TEST(Strokes, EndAtALongPauseButNotAtAShortOne) {
  std::vector<AttemptTick> ticks;
  for (int n = 0; n < 900; ++n) {
    const bool pauses = (n >= 200 && n < 250) || (n >= 500 && n < 700);
    ticks.push_back({.dt_s = 1e-3, .burr_W = {0.02 * n, 0, 0}, .removed_mm3 = pauses ? 0 : 1e-3});
  }
  EXPECT_EQ(strokes_of(ticks).size(), 2u);
}

// Cuts a shape from bone below z = 0, with an edge like that left by milling.
Attempt attempt_cutting(const PlacedExercise& placed, const Volume& scan,
                        const std::function<double(const Vec3&)>& signed_distance_mm) {
  Volume after = scan;
  const GridGeometry& grid = scan.geometry();
  for_each(grid.all_voxels(), [&](const VoxelIndex& v) {
    const double voxels = signed_distance_mm(grid.world_from_voxel(v)) / grid.spacing_mm.x();
    after.lower_density(v, static_cast<float>(std::clamp(500 + 500 * voxels, 0.0, 1000.0)));
  });
  VoxelSet removed = removed_voxels(scan, after);
  return {&placed, &scan, std::move(after), std::move(removed), {}, {}, {}, {}, {}};
}

class CutVolume : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(AtSpacings, CutVolume, ::testing::Values(0.125, 0.25),
                         [](const auto& of) { return of.param < 0.2 ? "EighthOfAMm" : "QuarterOfAMm"; });

TEST_P(CutVolume, MatchesASphereWithinTwoPercent) {
  const Volume bone = bone_below_zero(GetParam(), 8);
  const SphereShape sphere{{0.03, 0.05, -1.9}, 1.5};
  const PlacedExercise placed = place_exercise(exercise_with_target(region_of({sphere})), bone);
  const double expected_mm3 = 4 * std::numbers::pi / 3 * std::pow(1.5, 3);
  EXPECT_NEAR(placed.volume_mm3(placed.target.count()), expected_mm3, 0.02 * expected_mm3);
  const Attempt attempt = attempt_cutting(placed, bone, ball(sphere.center_W, sphere.radius_mm));
  EXPECT_NEAR(measured("removed_mm3", attempt), expected_mm3, 0.02 * expected_mm3);
  EXPECT_GT(measured("dice_percent", attempt), 98);
}

TEST_P(CutVolume, MatchesASlotWithinTwoPercent) {
  const Volume bone = bone_below_zero(GetParam(), 10);
  const Vec3 from(-2, 0.05, -1.4), to(2, 0.05, -1.4);
  const PlacedExercise placed =
      place_exercise(exercise_with_target(region_of({BoxShape{{-3, -1, -2.4}, {3, 1, 0}}})), bone);
  const Attempt attempt = attempt_cutting(placed, bone, [&](const Vec3& p) {
    const double along = std::clamp((p - from).x(), 0.0, 4.0);
    return (p - from - Vec3(along, 0, 0)).norm() - 1;
  });
  const double expected_mm3 = 4 * std::numbers::pi / 3 + 4 * std::numbers::pi;
  EXPECT_NEAR(measured("removed_mm3", attempt), expected_mm3, 0.02 * expected_mm3);
}

TEST_P(CutVolume, MatchesTheMillsCountWithinTwoPercent) {
  const Volume bone = bone_below_zero(GetParam(), 8);
  std::vector<Vec3> places = way({0.03, 0.05, 2.2}, {0.03, 0.05, 0.2}, 0.005);
  places.resize(places.size() + 3000, places.back());
  const Recording recording = record_poses(bone, places, 1.5);
  const PlacedExercise placed =
      place_exercise(exercise_with_target(region_of({SphereShape{{0.03, 0.05, 0.2}, 1.5}})), bone);
  const Attempt attempt = make_attempt(placed, bone, recording);
  const double counted_mm3 = recording.records.back().removed_mm3;
  EXPECT_GT(counted_mm3, 4);
  EXPECT_NEAR(measured("removed_mm3", attempt), counted_mm3, 0.02 * counted_mm3);
  EXPECT_GT(measured("target_removed_percent", attempt), 90);
  EXPECT_GT(measured("cutting_s", attempt), 0.1);
}

// Returns the volume below z = 0 swept by a ball along the simulated tool's path, by point counting.
double swept_mm3(const Recording& recording, double radius_mm) {
  constexpr double kApart_mm = 0.05;
  constexpr std::size_t kTicks = 25;
  std::vector<Vec3> path_W;
  for (std::size_t n = 0; n < recording.records.size(); n += kTicks)
    if (recording.records[n].X_WT.position_mm.z() < radius_mm)
      path_W.push_back(recording.records[n].X_WT.position_mm);
  std::size_t swept = 0;
  for (double z = -0.5 * kApart_mm; z > -2; z -= kApart_mm) {
    for (double y = -2; y < 2; y += kApart_mm) {
      for (double x = -4; x < 4; x += kApart_mm) {
        const Vec3 point_W(x, y, z);
        swept += std::ranges::any_of(path_W, [&](const Vec3& centre_W) {
          return (point_W - centre_W).squaredNorm() <= radius_mm * radius_mm;
        });
      }
    }
  }
  return static_cast<double>(swept) * std::pow(kApart_mm, 3);
}

// A resting burr would widen its hole: the skin of barrier-shell then holds it off by up to 0.1 mm,
// which milling bridges.
TEST_P(CutVolume, MatchesTheToolsSweptVolumeWithinTwoPercent) {
  const Volume bone = bone_below_zero(GetParam(), 10);
  const PlacedExercise placed =
      place_exercise(exercise_with_target(region_of({SphereShape{{0.03, 0.05, 0.2}, 1.5}})), bone);
  const auto lift = [](std::vector<Vec3> places) {
    const Vec3 last_W = places.back();
    for (int n = 1; n < 200; ++n) places.push_back(last_W + Vec3(0, 0, 0.02 * n));
    return places;
  };
  const std::vector<Vec3> plunge = way({0.03, 0.05, 1.7}, {0.03, 0.05, 0.2}, 0.0004);
  // Several voxels deep, because voxels are counted whole.
  std::vector<Vec3> slot = way({-1.97, 0.05, 1.7}, {-1.97, 0.05, -0.1}, 0.0005);
  for (const Vec3& place_W : way({-1.97, 0.05, -0.1}, {2.03, 0.05, -0.1}, 0.0008)) slot.push_back(place_W);
  for (const std::vector<Vec3>& places : {lift(plunge), lift(slot)}) {
    const Recording recording = record_poses(bone, places, 1.5);
    const double expected_mm3 = swept_mm3(recording, 1.5);
    EXPECT_GT(expected_mm3, 2);
    EXPECT_NEAR(measured("removed_mm3", make_attempt(placed, bone, recording)), expected_mm3,
                0.02 * expected_mm3);
  }
}

// A conical frustum within a cylinder of 4 mm; its sides lean by 4 degrees.
TEST(Crown, MeasuresReductionTaperAndUndercutOfKnownShapes) {
  const double lean = 4 * std::numbers::pi / 180;
  GridGeometry grid = centred_cube(56, 0.2);
  const auto cylinder = [](const Vec3& p) { return std::max(p.head<2>().norm() - 4, p.z() - 4); };
  const auto frustum = [&](const Vec3& p) {
    const double radius_mm = 3 - (p.z() + 3) * std::tan(lean);
    return std::max((p.head<2>().norm() - radius_mm) * std::cos(lean), p.z() - 2.5);
  };
  const Volume scan = shape_volume(grid, cylinder);
  Exercise exercise = exercise_with_target(region_of({ShellShape{1.6}, BoxShape{{-5, -5, -3}, {5, 5, 5}}}));
  exercise.crown_axis_W = Vec3::UnitZ();
  const PlacedExercise placed = place_exercise(exercise, scan);
  const auto cut = [&](const std::function<double(const Vec3&)>& left) {
    return attempt_cutting(placed, scan, [&](const Vec3& p) { return p.z() < -3 ? 1.0 : -left(p); });
  };
  const Attempt tapered = cut(frustum);
  EXPECT_NEAR(measured("taper_deg", tapered), 8, 1);
  // 1 mm at the margin, 1.38 mm at the top of the sides, and 1.5 mm from above on a seventh of the surface.
  EXPECT_NEAR(measured("reduction_median_mm", tapered), 1.22, 0.1);
  EXPECT_NEAR(measured("reduction_p10_mm", tapered), 1.04, 0.1);
  EXPECT_LT(measured("undercut_mm3", tapered), 0.05);
  // Upside down it has an undercut all round: a ring below the wider top.
  const Attempt undercut = cut([&](const Vec3& p) {
    const double radius_mm = 2.5 + (p.z() + 3) * std::tan(lean);
    return std::max((p.head<2>().norm() - radius_mm) * std::cos(lean), p.z() - 2.5);
  });
  EXPECT_NEAR(measured("taper_deg", undercut), -8, 1);
  const double top_mm = 2.5 + 5.5 * std::tan(lean);
  const double cone_mm3 = std::numbers::pi * 5.5 / 3 * (2.5 * 2.5 + 2.5 * top_mm + top_mm * top_mm);
  EXPECT_NEAR(measured("undercut_mm3", undercut), std::numbers::pi * 5.5 * top_mm * top_mm - cone_mm3, 2);
}

TEST(MakeAttempt, RefusesARecordingOfAnotherScan) {
  const Volume bone = bone_below_zero(0.5, 8), other = bone_below_zero(0.5, 10);
  const Recording recording = record_poses(other, way({0, 0, 3}, {0, 0, 2}, 0.1), 1);
  const PlacedExercise placed =
      place_exercise(exercise_with_target(region_of({BoxShape{{-1, -1, -1}, {1, 1, 0}}})), bone);
  EXPECT_THROW(make_attempt(placed, bone, recording), InputError);
}

}  // namespace
}  // namespace osteomill
