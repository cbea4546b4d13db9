#include "osteomill/volume/builtin_phantoms.h"

#include <algorithm>
#include <string_view>

#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"
#include "osteomill/volume/volume.h"

namespace osteomill {
namespace {

Volume phantom_named(std::string_view name) {
  const auto all = builtin_phantoms();
  const auto found = std::ranges::find(all, name, &BuiltinPhantom::name);
  return Volume(found->make(), found->isovalue);
}

TEST(BuiltinPhantom, LayersAlternateDenserAndSofterBone) {
  const Volume layers = phantom_named("layers");
  const auto at = [&](double z) { return density_at(layers.grid(), {0.3, -2, z}); };
  EXPECT_EQ(at(1), 0);
  EXPECT_EQ(at(-1), 1800);
  EXPECT_EQ(at(-3.5), 1200);
  EXPECT_EQ(at(-5.5), 1800);
  EXPECT_EQ(at(-8), 1200);
  EXPECT_NEAR(first_crossing(layers, {0, 0, 3}, {0, 0, -3})->z(), 0, 0.13);
}

TEST(BuiltinPhantom, MastoidEnclosesNerveInBoneAndHasAirCells) {
  const Volume mastoid = phantom_named("mastoid");
  const auto at = [&](const Vec3& point_W) { return density_at(mastoid.grid(), point_W); };
  EXPECT_EQ(at({-1, 0, -13}), 40);
  EXPECT_EQ(at({-9, 4, -6}), 40);
  EXPECT_EQ(at({0, 11, -8}), 40);
  EXPECT_EQ(at({1, 3, -9}), 0);
  std::size_t cells = 0, voxels = 0;
  for_each(mastoid.geometry().all_voxels(), [&](const VoxelIndex& v) {
    const Vec3 p = mastoid.geometry().world_from_voxel(v);
    // Solid bone around the nerve, on all sides.
    const double from_nerve_mm = Vec3(p.x() + 1, 0, p.z() + 13).norm() - 0.75;
    if (p.y() < 8 && from_nerve_mm > 0.3 && from_nerve_mm < 1) {
      EXPECT_TRUE(mastoid.is_bone(v));
    }
    if (p.x() < -4 || p.x() > 5 || p.y() < -6 || p.y() > 7 || p.z() < -11 || p.z() > -3) return;
    ++voxels;
    cells += mastoid.is_bone(v) ? 0u : 1u;
  });
  EXPECT_GT(static_cast<double>(cells), 0.15 * static_cast<double>(voxels));
  EXPECT_LT(static_cast<double>(cells), 0.6 * static_cast<double>(voxels));
}

}  // namespace
}  // namespace osteomill
