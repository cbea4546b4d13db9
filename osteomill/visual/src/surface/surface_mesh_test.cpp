#include "osteomill/visual/surface_mesh.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "osteomill/volume/builtin_tooth.h"

#include "tests/shapes.h"
#include "tests/support/mesh_checks.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::enclosed_volume_mm3;
using testing_support::euler_characteristic;
using testing_support::is_closed;
using testing_support::is_sound;
using testing_support::mesh_surface;
using testing_support::normal_of;
using testing_support::position_of;
using testing_support::shape_volume;
using testing_support::SurfaceMesh;
using testing_support::trilinear_volume_mm3;
using testing_support::welded_by_position;

Volume volume_of(const std::array<int, 3>& dims, std::vector<float> densities, double isovalue) {
  GridGeometry geometry;
  geometry.dims = dims;
  return Volume(DensityGrid(geometry, std::move(densities)), isovalue);
}

Volume random_volume(const std::array<int, 3>& dims, unsigned seed, int values = 1 << 24) {
  std::mt19937 random(seed);
  std::vector<float> densities(static_cast<std::size_t>(dims[0] * dims[1] * dims[2]));
  for (float& density : densities) density = static_cast<float>(random() % static_cast<unsigned>(values));
  return volume_of(dims, std::move(densities), values / 2);
}

// Meshes the volume brick by brick and in one piece, and checks that both agree.
BrickMesh checked_mesh(const Volume& volume) {
  const DensityView view(volume);
  const BrickMesh whole = mesh_in_one_piece(view);
  const BrickMesh welded = welded_by_position(mesh_surface(view));
  EXPECT_TRUE(is_sound(whole));
  EXPECT_TRUE(is_closed(welded));
  EXPECT_EQ(whole.vertices.size(), welded.vertices.size());
  EXPECT_EQ(whole.triangle_count(), welded.triangle_count());
  EXPECT_NEAR(enclosed_volume_mm3(whole), enclosed_volume_mm3(welded),
              1e-6 * (1 + enclosed_volume_mm3(whole)));
  return whole;
}

// Returns the bone volume of the voxels, each counted by its density relative to `full`.
double partial_volume_mm3(const Volume& volume, double full) {
  double sum = 0;
  for (const float density : every_nth_density(volume.grid(), 1))
    sum += std::clamp(static_cast<double>(density) / full, 0.0, 1.0);
  return sum * volume.geometry().voxel_volume_mm3();
}

void expect_volume_of_densities(const Volume& volume) {
  const double expected = trilinear_volume_mm3(volume);
  EXPECT_NEAR(enclosed_volume_mm3(checked_mesh(volume)), expected, 0.005 * expected);
}

TEST(SurfaceMesh, MeshOfBallIsClosedAndHasItsVolume) {
  const Volume volume = shape_volume(centred_cube(61, 0.25), ball({0.1, -0.2, 0.05}, 6.0));
  const BrickMesh mesh = checked_mesh(volume);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  const double analytic = 4.0 / 3.0 * std::numbers::pi * 216;
  EXPECT_NEAR(enclosed_volume_mm3(mesh), analytic, 0.005 * analytic);
  EXPECT_NEAR(enclosed_volume_mm3(mesh), partial_volume_mm3(volume, 1000), 0.005 * analytic);
  for (const MeshVertex& vertex : mesh.vertices) {
    const Vec3 from_centre = position_of(vertex) - Vec3(0.1, -0.2, 0.05);
    EXPECT_NEAR(from_centre.norm(), 6.0, 0.02);
    EXPECT_GT(normal_of(vertex).dot(from_centre.normalized()), 0.995);
  }
}

TEST(SurfaceMesh, MeshOfHollowBallHasTwoSpheres) {
  const auto outer = ball(Vec3::Zero(), 5.0);
  const auto inner = ball(Vec3::Zero(), 3.0);
  const Volume volume =
      shape_volume(centred_cube(50, 0.25), [&](const Vec3& p) { return std::max(outer(p), -inner(p)); });
  const BrickMesh mesh = checked_mesh(volume);
  EXPECT_EQ(euler_characteristic(mesh), 4);
  EXPECT_NEAR(enclosed_volume_mm3(mesh), 4.0 / 3.0 * std::numbers::pi * (125 - 27), 2);
}

TEST(SurfaceMesh, IsClosedWhereBoneTouchesTheBorder) {
  GridGeometry geometry = centred_cube(33, 0.25);
  geometry.dims = {33, 20, 47};
  const Volume volume = shape_volume(geometry, ball(geometry.origin_mm, 5.0));
  const BrickMesh mesh = checked_mesh(volume);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  // An octant of a ball, plus half a voxel on its three flat sides.
  const double eighth = 4.0 / 3.0 * std::numbers::pi * 125 / 8;
  const double sides = 3 * std::numbers::pi * 25 / 4 * 0.125;
  EXPECT_NEAR(enclosed_volume_mm3(mesh), eighth + sides, 0.02 * eighth);
}

TEST(SurfaceMesh, IsClosedForAll256CubeCases) {
  for (unsigned bone = 0; bone < 256; ++bone) {
    std::vector<float> densities(8);
    for (std::size_t corner = 0; corner < 8; ++corner) densities[corner] = bone >> corner & 1 ? 10.0f : 0.0f;
    const Volume volume = volume_of({2, 2, 2}, densities, 4);
    const BrickMesh mesh = checked_mesh(volume);
    EXPECT_EQ(mesh.empty(), bone == 0) << bone;
    EXPECT_EQ(enclosed_volume_mm3(mesh) > 0, bone != 0) << bone;
  }
}

// Random bone across brick borders, which includes every ambiguous face.
TEST(SurfaceMesh, IsClosedForRandomBone) {
  for (unsigned seed = 0; seed < 6; ++seed) checked_mesh(random_volume({37, 19, 34}, seed));
}

// Many densities equal the isovalue.
TEST(SurfaceMesh, IsClosedAndNotDegenerateIfDensitiesEqualIsovalue) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const BrickMesh mesh = checked_mesh(random_volume({20, 35, 18}, seed, 4));
    EXPECT_GT(testing_support::min_area_mm2(mesh), 1e-7);
  }
}

// Two bone voxels across a face's diagonal are separate pieces, whatever their surroundings.
TEST(SurfaceMesh, SeparatesBoneVoxelsTouchingAcrossAFaceDiagonal) {
  std::vector<float> densities(4 * 4 * 4, 0);
  densities[1 + 4 * (1 + 4 * 1)] = densities[2 + 4 * (2 + 4 * 1)] = 1;
  EXPECT_EQ(euler_characteristic(checked_mesh(volume_of({4, 4, 4}, densities, 0.5))), 4);
}

TEST(SurfaceMesh, MeshOfOneVoxelIsAnOctahedron) {
  std::vector<float> densities(27, 0);
  densities[13] = 100;
  const BrickMesh mesh = checked_mesh(volume_of({3, 3, 3}, densities, 50));
  EXPECT_EQ(mesh.vertices.size(), 6u);
  EXPECT_EQ(mesh.triangle_count(), 8u);
  EXPECT_NEAR(enclosed_volume_mm3(mesh), 4.0 / 3.0 * 0.125, 1e-5);
  const BrickMesh alone = checked_mesh(volume_of({1, 1, 1}, {100}, 50));
  EXPECT_EQ(alone.triangle_count(), 8u);
}

TEST(SurfaceMesh, IsEmptyWithoutBoneAndClosedBoxIfAllBone) {
  EXPECT_TRUE(checked_mesh(volume_of({20, 17, 3}, std::vector<float>(20 * 17 * 3, 5), 5)).empty());
  const BrickMesh box = checked_mesh(volume_of({20, 17, 3}, std::vector<float>(20 * 17 * 3, 6), 5));
  EXPECT_EQ(euler_characteristic(box), 2);
  EXPECT_GE(enclosed_volume_mm3(box), 19 * 16 * 2);
}

TEST(SurfaceMesh, IsFiniteForExtremeDensities) {
  const float max = std::numeric_limits<float>::max();
  std::mt19937 random(3);
  std::vector<float> densities(12 * 12 * 12);
  for (float& density : densities) density = random() % 2 ? max : -max;
  for (const double isovalue : {1.0, 3e38, -3e38}) checked_mesh(volume_of({12, 12, 12}, densities, isovalue));
}

TEST(SurfaceMesh, WindsOutwardsInRotatedAndMirroredFrames) {
  for (const bool mirrored : {false, true}) {
    GridGeometry geometry = centred_cube(30, 0.5);
    geometry.spacing_mm = {0.5, 0.4, 0.7};
    geometry.direction = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    if (mirrored) geometry.direction.col(1) *= -1;
    const Vec3 centre = geometry.world_from_voxel(Vec3(15, 14, 13));
    const BrickMesh mesh = checked_mesh(shape_volume(geometry, ball(centre, 4.0)));
    EXPECT_NEAR(enclosed_volume_mm3(mesh), 4.0 / 3.0 * std::numbers::pi * 64, 4);
    for (const MeshVertex& vertex : mesh.vertices) {
      EXPECT_GT(normal_of(vertex).dot((position_of(vertex) - centre).normalized()), 0.97);
    }
  }
}

// A bone stored with flipped or exchanged axes has the same vertices.
TEST(SurfaceMesh, DoesNotDependOnAxisOrderOrFlips) {
  const Volume volume = random_volume({17, 18, 19}, 7, 1000);
  GridGeometry stored;
  stored.dims = {19, 17, 18};
  stored.direction.col(0) = -Vec3::UnitZ();
  stored.direction.col(1) = Vec3::UnitX();
  stored.direction.col(2) = -Vec3::UnitY();
  stored.origin_mm = {0, 17, 18};
  std::vector<float> densities;
  for (int k = 0; k < 18; ++k) {
    for (int j = 0; j < 17; ++j) {
      for (int i = 0; i < 19; ++i) densities.push_back(volume.grid()[{j, 17 - k, 18 - i}]);
    }
  }
  const BrickMesh mesh = checked_mesh(volume);
  const BrickMesh other = checked_mesh(Volume(DensityGrid(stored, densities), volume.isovalue()));
  EXPECT_EQ(mesh.triangle_count(), other.triangle_count());
  EXPECT_NEAR(enclosed_volume_mm3(mesh), enclosed_volume_mm3(other), 1e-3 * enclosed_volume_mm3(mesh));
  const auto rounded = [](const BrickMesh& m) {
    std::multiset<std::array<long, 3>> positions;
    for (const MeshVertex& v : m.vertices) {
      positions.insert({std::lround(v.position_mm[0] * 100), std::lround(v.position_mm[1] * 100),
                        std::lround(v.position_mm[2] * 100)});
    }
    return positions;
  };
  std::vector<std::array<long, 3>> different;
  const auto a = rounded(mesh), b = rounded(other);
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(different));
  EXPECT_LT(different.size(), mesh.vertices.size() / 500);  // rounding differences
}

TEST(SurfaceMesh, BrickMeshedAloneEqualsBrickOfWholeSurface) {
  const Volume volume = random_volume({70, 40, 50}, 1);
  const SurfaceMesh in_turn = mesh_surface(DensityView(volume));
  for (std::size_t brick = 0; brick < in_turn.bricks.size(); ++brick) {
    EXPECT_EQ(in_turn.bricks[brick], mesh_brick(DensityView(volume), brick));
  }
}

TEST(SurfaceMesh, VerticesCarryDensityOfUnderlyingBone) {
  const Volume volume = shape_volume(centred_cube(40, 0.25), ball(Vec3::Zero(), 3.0), 1.0);
  for (const MeshVertex& vertex : mesh_in_one_piece(DensityView(volume)).vertices) {
    EXPECT_GT(vertex.density, 500.0f);
    EXPECT_LE(vertex.density, 1000.0f);
  }
}

// Angles between the vertices' normals and the true normals, degrees.
struct AngleErrors {
  double rms_deg = 0;
  double max_deg = 0;
};

template <typename Outward>
AngleErrors angle_errors(const Volume& volume, const Outward& outward) {
  AngleErrors errors;
  double count = 0;
  for (const MeshVertex& vertex : mesh_in_one_piece(DensityView(volume)).vertices) {
    const std::optional<Vec3> expected = outward(position_of(vertex));
    if (!expected) continue;
    const double cosine = normal_of(vertex).dot(expected->normalized());
    const double angle_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
    errors.rms_deg += angle_deg * angle_deg;
    errors.max_deg = std::max(errors.max_deg, angle_deg);
    ++count;
  }
  errors.rms_deg = std::sqrt(errors.rms_deg / count);
  return errors;
}

// Central differences are off by 8.1 degrees (rms) and at most 15 if the edge is one voxel wide, by 1.8 and
// 5.2 if it is two; this is visible as terraces.
TEST(SurfaceMesh, BallNormalsMatchSphereAtAnyVoxelSizeAndEdgeWidth) {
  for (const double voxel_mm : {0.03, 0.25, 1.0}) {
    for (const double edge_voxels : {1.0, 2.0, 4.0}) {
      const Vec3 centre = voxel_mm * Vec3(0.4, -0.3, 0.2);
      const Volume volume =
          shape_volume(centred_cube(61, voxel_mm), ball(centre, 24 * voxel_mm), edge_voxels);
      const AngleErrors errors =
          angle_errors(volume, [&](const Vec3& p) { return std::optional<Vec3>(p - centre); });
      EXPECT_LT(errors.rms_deg, 0.6) << voxel_mm << " mm, " << edge_voxels << " voxels";
      EXPECT_LT(errors.max_deg, 2.0) << voxel_mm << " mm, " << edge_voxels << " voxels";
    }
  }
}

// Central differences are off by 2.0 degrees (rms) and at most 4.1.
TEST(SurfaceMesh, CylinderNormalsAreRadialInAnisotropicVoxels) {
  GridGeometry geometry = centred_cube(61, 0.25);
  geometry.spacing_mm.z() = 0.6;
  const Volume volume = shape_volume(geometry, [](const Vec3& p) { return p.head<2>().norm() - 5; });
  // Ignore its flat ends.
  const AngleErrors errors = angle_errors(volume, [&](const Vec3& p) -> std::optional<Vec3> {
    if (p.z() < geometry.origin_mm.z() + 2 || p.z() > geometry.origin_mm.z() + 34) return std::nullopt;
    return Vec3(p.x(), p.y(), 0);
  });
  EXPECT_LT(errors.rms_deg, 0.4);
  EXPECT_LT(errors.max_deg, 1.0);
}

// A vertical face of two materials, one above the other, with a sharp boundary at an angle to the grid.
TEST(SurfaceMesh, DensitiesVarySmoothlyAcrossMaterialBoundary) {
  constexpr double kVoxel_mm = 0.25, kSoft = 1500, kHard = 2800;
  const GridGeometry geometry = centred_cube(48, kVoxel_mm);
  const auto above = [](const Vec3& p) { return p.z() - 0.12 * p.y() - 0.03; };
  std::vector<float> densities;
  for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
    const Vec3 p = geometry.world_from_voxel(v);
    const double inside = std::clamp(0.5 - (p.x() + 0.3 * p.y()) / (2 * kVoxel_mm), 0.0, 1.0);
    densities.push_back(static_cast<float>(inside * (above(p) > 0 ? kHard : kSoft)));
  });
  const BrickMesh mesh =
      mesh_in_one_piece(DensityView(Volume(DensityGrid(geometry, std::move(densities)), 750)));
  const auto on_face = [](const MeshVertex& vertex) {
    const Vec3 p = position_of(vertex);
    return p.x() > -4 && std::abs(p.y()) < 4.5 && std::abs(p.z()) < 4.5;
  };
  // By height above the boundary, in half voxels.
  std::map<int, std::pair<double, int>> sums;
  std::map<int, std::pair<double, double>> ranges;
  for (const MeshVertex& vertex : mesh.vertices) {
    if (!on_face(vertex)) continue;
    const double density = static_cast<double>(vertex.density);
    const int height = static_cast<int>(std::floor(above(position_of(vertex)) / (0.5 * kVoxel_mm)));
    sums[height].first += density;
    ++sums[height].second;
    auto& [least, most] = ranges.try_emplace(height, density, density).first->second;
    least = std::min(least, density);
    most = std::max(most, density);
  }
  double before = 0;
  for (const auto& [height, sum] : sums) {
    const double mean = sum.first / sum.second;
    EXPECT_GT(mean, before - 0.01 * (kHard - kSoft)) << height;
    before = mean;
    if (std::abs(height) < 6) continue;
    // Away from the boundary each material has one density, independent of voxel positions.
    EXPECT_LT(ranges[height].second - ranges[height].first, 0.05 * (kHard - kSoft)) << height;
  }
  // With the density at a single point below each vertex, neighbours would differ by 0.73 of the step.
  for (std::size_t n = 0; n < mesh.indices.size(); ++n) {
    const MeshVertex& a = mesh.vertices[mesh.indices[n]];
    const MeshVertex& b = mesh.vertices[mesh.indices[n % 3 == 2 ? n - 2 : n + 1]];
    if (!on_face(a) || !on_face(b)) continue;
    ASSERT_LT(std::abs(a.density - b.density), 0.6 * (kHard - kSoft));
  }
}

TEST(SurfaceMesh, FollowsTheGivenIsovalue) {
  const Volume volume = shape_volume(centred_cube(50, 0.25), ball(Vec3::Zero(), 4.0), 4.0);
  const auto radius = [&](double isovalue) {
    const BrickMesh mesh = mesh_in_one_piece({volume.grid(), volume.ranges(), isovalue});
    return std::cbrt(enclosed_volume_mm3(mesh) * 3 / 4 / std::numbers::pi);
  };
  EXPECT_NEAR(radius(500), 4.0, 0.01);
  EXPECT_NEAR(radius(250), 4.25, 0.01);
  EXPECT_NEAR(radius(750), 3.75, 0.01);
}

// A change of one voxel affects only the bricks that the layout returns, and each of those for some change.
TEST(SurfaceBricks, BricksDependingOnAVoxelIncludeAllThatChange) {
  Volume volume = random_volume({50, 33, 40}, 5);
  const SurfaceMesh before = mesh_surface(DensityView(volume));
  std::mt19937 random(1);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int n = 0; n < 60; ++n) {
    Volume changed = volume;
    const VoxelIndex voxel{below(50), below(33), below(40)};
    changed.lower_density(voxel, -5);
    const SurfaceMesh after = mesh_surface(DensityView(changed));
    const VoxelBox touched = before.layout.bricks_depending_on({voxel, voxel});
    for (std::size_t brick = 0; brick < after.bricks.size(); ++brick) {
      const auto [bi, bj, bk] = before.layout.coordinates(brick);
      EXPECT_TRUE(touched.contains({bi, bj, bk}) || before.bricks[brick] == after.bricks[brick]);
    }
  }
  EXPECT_TRUE(before.layout.bricks_depending_on({}).empty());
}

TEST(SurfaceMesh, MeshOfBuiltinToothIsClosedAndHasItsVolume) {
  expect_volume_of_densities(Volume(builtin_tooth(0.5), kBuiltinToothIsovalue));
}

}  // namespace
}  // namespace osteomill
