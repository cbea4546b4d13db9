#include "osteomill/volume/label_scan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

using Shape = std::function<double(const Vec3&)>;

const GridGeometry kGrid = centred_cube(24, 0.5);

DensityGrid filled(const Shape& value) {
  std::vector<float> values;
  for_each(kGrid.all_voxels(), [&](const VoxelIndex& v) {
    values.push_back(static_cast<float>(value(kGrid.world_from_voxel(v))));
  });
  return DensityGrid(kGrid, std::move(values));
}

// Returns labels as in a brain segmentation: white matter of either side, cortex parcels, nuclei inside.
double brain(const Vec3& p) {
  const double from_mm = p.norm();
  if (from_mm > 5) return 0;
  if (from_mm > 4) return (p.x() < 0 ? 1000 : 2000) + (p.y() < 0 ? 1 : 12) + (p.z() < 0 ? 23 : 0);
  if (std::abs(p.x()) < 1.6 && from_mm < 2.5) return p.z() < 0 ? 16 : 10;
  return p.x() < 0 ? 2 : 41;
}

TEST(LabelScan, RecognisesSegmentationsAndMasksAsLabels) {
  EXPECT_EQ(LabelGuess::labels, guess_labels(filled(brain)));
  for (const double inside : {1.0, 255.0})
    EXPECT_EQ(LabelGuess::labels,
              guess_labels(filled([&](const Vec3& p) { return p.norm() < 4 ? inside : 0; })));
  EXPECT_EQ(LabelGuess::labels, guess_labels(filled([](const Vec3& p) {
              return p.norm() > 5 ? 0 : p.z() > 1 ? 3 : p.z() < -1 ? 2 : 1;
            })));
}

// The brain with `strays` scattered voxels of another label.
DensityGrid strewn(std::size_t strays, double label) {
  std::vector<float> values = every_nth_density(filled(brain), 1);
  std::size_t left = strays;
  for (std::size_t n = 5; left > 0 && n < values.size(); n += 7) {
    if (values[n] == 0) continue;
    values[n] = static_cast<float>(label);
    --left;
  }
  EXPECT_EQ(left, 0u);
  return DensityGrid(kGrid, std::move(values));
}

TEST(LabelScan, StillRecognisesLabelsDespiteStrayVoxels) {
  for (const double label : {1.0, 12.0, 300.0, 3000.0}) {
    for (const std::size_t strays : {1u, 3u, 12u})
      EXPECT_EQ(LabelGuess::labels, guess_labels(strewn(strays, label))) << strays << " of " << label;
  }
}

// A phantom's edges contain a few voxels of other levels, which must not make it look like touching
// structures.
TEST(LabelScan, StrayVoxelsDoNotMakeAPhantomLookLikeLabels) {
  int number = 0;
  const DensityGrid phantom = filled([&](const Vec3& p) {
    const double level = p.norm() < 2 ? 2000 : p.norm() < 5 ? 1000 : 0;
    return level == 1000 && ++number % 900 == 0 ? 1 + number : level;
  });
  EXPECT_EQ(LabelGuess::unclear, guess_labels(phantom));
}

TEST(LabelScan, IsUnclearIfLevelsCouldBeLabels) {
  const auto onion = [](const Vec3& p) { return p.norm() < 3 ? 2 : p.norm() < 5 ? 1 : 0; };
  EXPECT_EQ(LabelGuess::unclear, guess_labels(filled(onion)));
  // A thin shell between two structures.
  EXPECT_EQ(LabelGuess::unclear, guess_labels(filled([](const Vec3& p) {
              return p.norm() < 3 ? 3 : p.norm() < 3.6 ? 2 : p.norm() < 5 ? 1 : 0;
            })));
  // Labels that fill more than half of the grid.
  EXPECT_EQ(LabelGuess::unclear, guess_labels(filled([](const Vec3& p) {
              return p.x() > 3 ? 0 : p.y() > 0 ? 3 : p.z() < 0 ? 2 : 1;
            })));
}

// Air, a head of soft tissue and a skull, blurred over a voxel and quantised to a few levels.
TEST(LabelScan, DoesNotTakeACtOfFewLevelsForLabels) {
  const auto step = [](double from_mm) { return std::clamp(0.5 - from_mm, 0.0, 1.0); };
  for (const int levels : {3, 4, 8, 16}) {
    const DensityGrid ct = filled([&](const Vec3& p) {
      const double skull = step(std::abs(p.norm() - 3) - 0.8);
      return std::floor(0.999 * levels * (0.45 * step(p.norm() - 5) + 0.55 * skull));
    });
    EXPECT_NE(LabelGuess::labels, guess_labels(ct)) << levels;
  }
}

TEST(LabelScan, DoesNotTakeDensitiesForLabels) {
  const auto phantom = [](const Vec3& p) { return p.norm() < 2 ? 1200 : p.norm() < 4 ? 40 : -1000; };
  EXPECT_EQ(LabelGuess::densities, guess_labels(filled(phantom)));
  EXPECT_NE(LabelGuess::labels, guess_labels(filled([&](const Vec3& p) { return phantom(p) + 1000.5; })));
  EXPECT_EQ(LabelGuess::densities, guess_labels(filled([](const Vec3&) { return 3; })));
  // Shape whose edge has a single intermediate level, at any sub-voxel offset and orientation.
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 2, 3), Vec3(1, 1, 1)}) {
    const Vec3 way = normal.normalized();
    for (const double offset_mm : {0.0, 0.11, 0.25}) {
      const Vec3 point = offset_mm * way;
      const Shape flat = plane(point, way);
      const Shape edge = [&](const Vec3& p) { return std::max(flat(p), way.unitOrthogonal().dot(p)); };
      for (const Shape& shape : {flat, edge, Shape(ball(point, 3.5))}) {
        const Volume soft = shape_volume(kGrid, shape);
        const DensityGrid shades =
            filled([&](const Vec3& p) { return 1000 * std::round(2e-3 * density_at(soft.grid(), p)); });
        EXPECT_NE(LabelGuess::labels, guess_labels(shades)) << normal.transpose() << " " << offset_mm;
      }
    }
  }
}

TEST(LabelScan, LabelsBecomeBoneOfOneDensity) {
  const DensityGrid labels = filled(brain);
  EXPECT_EQ(isovalue_of_labels(labels), 1);
  for (const double isovalue : {1.0, 50.5}) {
    const DensityGrid bone = bone_of_labels(labels, isovalue);
    for_each(kGrid.all_voxels(), [&](const VoxelIndex& v) {
      const double above = static_cast<double>(labels[v]) > isovalue ? 0.5 : -0.5;
      EXPECT_EQ(static_cast<double>(bone[v]), isovalue + above);
    });
  }
  EXPECT_EQ(isovalue_of_labels(filled([](const Vec3&) { return 7; })), 7);
}

}  // namespace
}  // namespace osteomill
