#include "slice_stack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"

namespace osteomill {
namespace {

// Slices along the normal of a rotated grid, in order.
std::vector<SlicePlane> series(int count, double distance_mm, const Mat3& axes = Mat3::Identity()) {
  std::vector<SlicePlane> slices;
  for (int k = 0; k < count; ++k) {
    SlicePlane slice;
    slice.name = "slice" + std::to_string(k);
    slice.instance = "uid" + std::to_string(k);
    slice.columns = 8;
    slice.rows = 6;
    slice.column_distance_mm = 0.5;
    slice.row_distance_mm = 0.25;
    slice.i_direction = axes.col(0);
    slice.j_direction = axes.col(1);
    slice.position_mm = Vec3(1, 2, 3) + axes.col(2) * (distance_mm * k);
    slices.push_back(slice);
  }
  return slices;
}

std::string refusal(const std::vector<SlicePlane>& slices) {
  try {
    stack_slices("folder", slices);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

Mat3 some_rotation() {
  return Quat(0.8, 0.2, -0.4, 0.4).normalized().toRotationMatrix();
}

TEST(SliceStack, OrdersSlicesByPositionInAnyFileOrder) {
  const Mat3 axes = some_rotation();
  std::vector<SlicePlane> slices = series(12, 0.75, axes);
  std::shuffle(slices.begin(), slices.end(), std::mt19937(7));
  const SliceStack stack = stack_slices("folder", slices);
  EXPECT_EQ(stack.geometry.dims, (std::array<int, 3>{8, 6, 12}));
  EXPECT_TRUE(stack.geometry.spacing_mm.isApprox(Vec3(0.5, 0.25, 0.75), 1e-12));
  EXPECT_TRUE(stack.geometry.origin_mm.isApprox(Vec3(1, 2, 3), 1e-12));
  EXPECT_TRUE(stack.geometry.direction.isApprox(axes, 1e-12));
  for (int k = 0; k < 12; ++k) {
    EXPECT_EQ(slices[stack.order[static_cast<std::size_t>(k)]].name, "slice" + std::to_string(k));
  }
  EXPECT_TRUE(stack.warnings.empty());
  EXPECT_EQ(stack.drift_i_mm, 0);
  EXPECT_EQ(stack.drift_j_mm, 0);
}

TEST(SliceStack, AcceptsEvenSlicesWithRoundedPositions) {
  std::vector<SlicePlane> slices = series(200, 0.625);
  for (SlicePlane& slice : slices) slice.position_mm.z() = std::round(100 * slice.position_mm.z()) / 100;
  EXPECT_NEAR(stack_slices("folder", slices).geometry.spacing_mm.z(), 0.625, 1e-3);
}

// Slices with positions rounded to few decimals, as some writers do.
std::vector<SlicePlane> rounded_series(double distance_mm, int decimals) {
  std::vector<SlicePlane> slices = series(24, distance_mm);
  const double unit = std::pow(10.0, decimals);
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].position_mm.z() = std::nearbyint(unit * slices[k].position_mm.z()) / unit;
    slices[k].decimals = {decimals, decimals, std::max(decimals, 1)};
    slices[k].number = static_cast<int>(k) + 1;
  }
  return slices;
}

TEST(SliceStack, OrdersCoarselyRoundedPositionsByNumber) {
  for (const auto& [distance_mm, decimals] :
       {std::pair{0.15, 1}, {0.25, 1}, {0.33, 1}, {0.4, 0}, {0.625, 0}}) {
    std::vector<SlicePlane> slices = rounded_series(distance_mm, decimals);
    std::shuffle(slices.begin(), slices.end(), std::mt19937(7));
    const SliceStack stack = stack_slices("folder", slices);
    EXPECT_NEAR(stack.geometry.spacing_mm.z(), distance_mm, std::pow(0.1, decimals) / 23) << distance_mm;
    EXPECT_TRUE(stack.heights_mm.empty());
    for (int k = 0; k < 24; ++k)
      EXPECT_EQ(slices[stack.order[static_cast<std::size_t>(k)]].number, k + 1) << distance_mm;
    ASSERT_EQ(stack.warnings.size(), 1U);
    EXPECT_TRUE(contains(stack.warnings[0], decimals == 0 ? "rounded to 1 mm" : "rounded to 0.1 mm"));
  }
}

TEST(SliceStack, RefusesMissingOrRepeatedSlicesDespiteRounding) {
  std::vector<SlicePlane> missing = rounded_series(0.25, 1);
  missing.erase(missing.begin() + 9);
  EXPECT_TRUE(contains(refusal(missing), "a slice is missing"));
  // Renumbering the rest from 0 does not help.
  for (std::size_t k = 0; k < missing.size(); ++k) missing[k].number = static_cast<int>(k);
  EXPECT_TRUE(contains(refusal(missing), "a slice is missing"));
  // Two slices at every position may be two time points.
  std::vector<SlicePlane> twice = rounded_series(1, 0);
  for (std::size_t k = 0; k < 24; ++k) twice[k].position_mm.z() = static_cast<double>(k / 2);
  EXPECT_TRUE(contains(refusal(twice), "positions are rounded to 1 mm, or there are several"));
  std::vector<SlicePlane> repeated = rounded_series(0.4, 0);
  for (std::size_t k = 0; k < 24; ++k) repeated[k].number = static_cast<int>(k % 12);
  EXPECT_TRUE(contains(refusal(repeated), "different images at one position"));
}

TEST(SliceStack, RecognisesACopyByItsPixels) {
  std::vector<SlicePlane> slices = series(6, 0.5);
  slices.push_back(slices[3]);
  slices.back().instance = "another";
  EXPECT_TRUE(contains(refusal(slices), "different images at one position"));
  const SliceStack stack =
      stack_slices("folder", slices, [](std::size_t a, std::size_t b) { return a + b == 9; });
  EXPECT_EQ(stack.geometry.dims[2], 6);
  EXPECT_TRUE(contains(stack.warnings.at(0), "1 copy of other slices"));
}

TEST(SliceStack, SkipsCopiesOfSlicesWithRoundedPositions) {
  for (const auto& [distance_mm, decimals] : {std::pair{0.15, 1}, {0.4, 0}}) {
    std::vector<SlicePlane> slices = rounded_series(distance_mm, decimals);
    for (const std::size_t k : {3U, 4U, 20U}) {
      slices.push_back(slices[k]);
      slices.back().instance = "another";
    }
    const std::array<std::size_t, 3> originals{3, 4, 20};
    const SliceStack stack = stack_slices("folder", slices, [&](std::size_t a, std::size_t b) {
      return std::max(a, b) >= 24 && originals[std::max(a, b) - 24] == std::min(a, b);
    });
    EXPECT_EQ(stack.geometry.dims[2], 24) << distance_mm;
    EXPECT_NEAR(stack.geometry.spacing_mm.z(), distance_mm, std::pow(0.1, decimals) / 23);
    ASSERT_EQ(stack.warnings.size(), 2U);
    EXPECT_TRUE(contains(stack.warnings[0], "3 copies of other slices"));
  }
}

TEST(SliceStack, ReportsBetweenWhichSlicesOneIsMissing) {
  for (const int missing : {1, 6, 10}) {
    std::vector<SlicePlane> slices = series(12, 0.25);
    slices.erase(slices.begin() + missing);
    const std::string reason = refusal(slices);
    EXPECT_TRUE(contains(reason, "folder: a slice is missing: 0.5 mm")) << reason;
    EXPECT_TRUE(contains(reason, ("slice" + std::to_string(missing - 1) + " and").c_str())) << reason;
  }
}

// Returns the pixels of slices, sampled from `density`.
template <typename Density>
std::vector<float> pixels_of(const std::vector<SlicePlane>& slices, const SliceStack& stack,
                             const Density& density) {
  std::vector<float> densities;
  for (const std::size_t n : stack.order) {
    const SlicePlane& slice = slices[n];
    for (int j = 0; j < slice.rows; ++j) {
      for (int i = 0; i < slice.columns; ++i) {
        densities.push_back(static_cast<float>(density(slice.position_mm +
                                                       slice.i_direction * (slice.column_distance_mm * i) +
                                                       slice.j_direction * (slice.row_distance_mm * j))));
      }
    }
  }
  return densities;
}

TEST(SliceStack, InterpolatesUnevenSlicesWithAWarning) {
  const auto density = [](const Vec3& p) { return 1000 + 3 * p.x() - 5 * p.y() + 7 * p.z(); };
  // Slices with a change of the table feed, overlapping at the change.
  std::vector<SlicePlane> slices = series(11, 0);
  double height_mm = 3;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].position_mm.z() = height_mm;
    height_mm += k < 5 ? 2 : k == 5 ? 0.5 : 3.5;
  }
  SliceStack stack = stack_slices("folder", slices);
  ASSERT_EQ(stack.warnings.size(), 1U);
  EXPECT_EQ(stack.warnings.front(),
            "slices are uneven, 0.5 to 3.5 mm between slice6 and slice7: interpolated to 13 slices 2.04167 "
            "mm apart");
  EXPECT_EQ(stack.geometry.dims[2], 13);
  std::vector<float> densities = pixels_of(slices, stack, density);
  resample_to_even_slices(stack, densities);
  ASSERT_EQ(densities.size(), stack.geometry.voxel_count());
  std::size_t n = 0;
  for (int k = 0; k < 13; ++k) {
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 8; ++i, ++n) {
        const Vec3 p = stack.geometry.world_from_voxel(VoxelIndex{i, j, k});
        EXPECT_NEAR(static_cast<double>(densities[n]), density(p), 1e-3);
      }
    }
  }
  EXPECT_TRUE(stack.heights_mm.empty());
}

TEST(SliceStack, WarnsOfSlowlyGrowingDistances) {
  std::vector<SlicePlane> slices = series(60, 1.0);
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const auto n = static_cast<double>(k);
    slices[k].position_mm.z() = n + 0.0005 * n * n;
  }
  EXPECT_TRUE(contains(stack_slices("folder", slices).warnings.front(), "uneven"));
}

TEST(SliceStack, NanSpreadsOnlyToSlicesInterpolatedFromIt) {
  std::vector<SlicePlane> slices = series(5, 1);
  slices[4].position_mm.z() += 0.25;
  SliceStack stack = stack_slices("folder", slices);
  std::vector<float> densities(5 * 48, 5.0F);
  densities[48 * 2 + 7] = std::numeric_limits<float>::quiet_NaN();
  resample_to_even_slices(stack, densities);
  EXPECT_EQ(stack.geometry.dims[2], 5);
  // The second and third slice are interpolated from the one with NaN.
  EXPECT_EQ(
      std::count_if(densities.begin(), densities.end(), [](float density) { return std::isnan(density); }),
      2);
  EXPECT_TRUE(std::isnan(densities[48 * 2 + 7]));
  EXPECT_EQ(std::count(densities.begin(), densities.end(), 5.0F), 5 * 48 - 2);
}

TEST(SliceStack, RefusesANegativePixelSpacing) {
  std::vector<SlicePlane> slices = series(4, 0.5);
  for (SlicePlane& slice : slices) slice.column_distance_mm = -0.125;
  EXPECT_TRUE(contains(refusal(slices), "voxels -0.125 mm apart"));
}

TEST(SliceStack, RefusesUnevenDistancesTooWideToInterpolate) {
  std::vector<SlicePlane> slices = series(12, 8);
  for (std::size_t k = 6; k < slices.size(); ++k)
    slices[k].position_mm.z() += 3 * (static_cast<double>(k) - 5);
  EXPECT_TRUE(contains(refusal(slices), "too wide to interpolate: 11 mm between slice5 and slice6"));
}

TEST(SliceStack, SkipsACopyButRefusesAnotherImageAtItsPosition) {
  std::vector<SlicePlane> slices = series(5, 1.0);
  slices.push_back(slices[2]);
  slices.back().name = "again";
  const SliceStack stack = stack_slices("folder", slices);
  EXPECT_EQ(stack.order.size(), 5U);
  EXPECT_EQ(stack.warnings.size(), 1U);
  slices.back().instance = "other";
  EXPECT_TRUE(contains(refusal(slices), "different images at one position"));
}

TEST(SliceStack, RefusesSlicesWithoutAGrid) {
  const auto changed = [](auto&& change) {
    std::vector<SlicePlane> slices = series(5, 1.0);
    change(slices[3]);
    return refusal(slices);
  };
  EXPECT_TRUE(contains(changed([](SlicePlane& s) { s.rows = 5; }), "size"));
  EXPECT_TRUE(contains(changed([](SlicePlane& s) { s.row_distance_mm = 0.3; }), "pixel spacing"));
  EXPECT_TRUE(
      contains(changed([](SlicePlane& s) { std::swap(s.i_direction, s.j_direction); }), "orientation"));
  EXPECT_TRUE(contains(changed([](SlicePlane& s) { s.j_direction = s.i_direction; }), "orthogonal"));
  EXPECT_TRUE(contains(changed([](SlicePlane& s) { s.position_mm.x() += 1; }), "to the side"));
  EXPECT_TRUE(contains(refusal(series(1, 1.0)), "only one slice"));
  EXPECT_TRUE(contains(refusal(series(5, 500)), "mm apart"));
  EXPECT_TRUE(contains(refusal({}), "no slices"));
}

// Linear interpolation preserves a linear density exactly, so the result is known at every voxel.
TEST(GantryTilt, CorrectionPreservesALinearDensity) {
  const auto density = [](const Vec3& p) { return 1000 + 3 * p.x() - 5 * p.y() + 7 * p.z(); };
  for (const Vec3& drift_mm : {Vec3(0.11, -0.2, 0), Vec3(-0.3, 0.07, 0), Vec3(0, 0.25, 0)}) {
    const Mat3 axes = some_rotation();
    std::vector<SlicePlane> slices = series(7, 0.5, axes);
    std::vector<float> densities;
    for (std::size_t k = 0; k < slices.size(); ++k) {
      slices[k].position_mm += axes * drift_mm * static_cast<double>(k);
      for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 8; ++i) {
          const Vec3 place_mm = slices[k].position_mm + axes * Vec3(0.5 * i, 0.25 * j, 0);
          densities.push_back(static_cast<float>(density(place_mm)));
        }
      }
    }
    SliceStack stack = stack_slices("folder", slices);
    EXPECT_NEAR(stack.drift_j_mm, drift_mm.y(), 1e-12);
    const float outside = *std::min_element(densities.begin(), densities.end());
    correct_gantry_tilt("folder", stack, densities);
    ASSERT_EQ(densities.size(), stack.geometry.voxel_count());
    EXPECT_EQ(stack.warnings.size(), 1U);

    int inside = 0;
    std::size_t n = 0;
    for (int k = 0; k < stack.geometry.dims[2]; ++k) {
      for (int j = 0; j < stack.geometry.dims[1]; ++j) {
        for (int i = 0; i < stack.geometry.dims[0]; ++i, ++n) {
          const Vec3 p = stack.geometry.world_from_voxel(VoxelIndex{i, j, k});
          const Vec3 in_slice = axes.transpose() * (p - slices[static_cast<std::size_t>(k)].position_mm);
          const double u = in_slice.x() / 0.5;
          const double v = in_slice.y() / 0.25;
          if (u >= -1e-9 && u <= 7 + 1e-9 && v >= -1e-9 && v <= 5 + 1e-9) {
            ++inside;
            EXPECT_NEAR(static_cast<double>(densities[n]), density(p), 1e-3) << i << " " << j << " " << k;
          } else if (u < -1 || u > 8 || v < -1 || v > 6) {
            EXPECT_EQ(densities[n], outside);
          }
        }
      }
    }
    EXPECT_GE(inside, 7 * 5 * 7);
  }
}

TEST(GantryTilt, KeepsTheGridOfAStraightStack) {
  SliceStack stack = stack_slices("folder", series(3, 1.0));
  std::vector<float> densities(3 * 6 * 8, 5.0F);
  correct_gantry_tilt("folder", stack, densities);
  EXPECT_EQ(stack.geometry.dims, (std::array<int, 3>{8, 6, 3}));
  EXPECT_TRUE(stack.warnings.empty());
}

TEST(GantryTilt, RefusesATiltBeyondTheGantryLimit) {
  std::vector<SlicePlane> slices = series(4, 0.5);
  for (std::size_t k = 0; k < slices.size(); ++k) slices[k].position_mm.x() += 0.6 * static_cast<double>(k);
  SliceStack stack = stack_slices("folder", slices);
  std::vector<float> densities(4 * 6 * 8, 5.0F);
  EXPECT_THROW(correct_gantry_tilt("folder", stack, densities), InputError);
}

}  // namespace
}  // namespace osteomill
