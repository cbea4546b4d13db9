#include "osteomill/study/bone_page.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/visual/surface_mesh.h"
#include "osteomill/volume/volume.h"

namespace osteomill {
namespace {

constexpr double kRadius_mm = 4;

// Returns a ball about the origin, from its distance function.
BrickMesh ball() {
  GridGeometry geometry;
  geometry.dims = {48, 48, 48};
  geometry.spacing_mm = {0.2, 0.2, 0.2};
  geometry.origin_mm = {-4.7, -4.7, -4.7};
  std::vector<float> densities;
  for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
    densities.push_back(static_cast<float>(kRadius_mm - geometry.world_from_voxel(v).norm()));
  });
  return mesh_in_one_piece(DensityView(Volume(DensityGrid(geometry, std::move(densities)), 0)));
}

// Uses Gauss's theorem.
double volume_mm3(const BrickMesh& mesh) {
  double volume_mm3 = 0;
  const auto corner = [&](std::size_t n) { return vec3_of(mesh.vertices[mesh.indices[n]].position_mm); };
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3)
    volume_mm3 += corner(n).dot(corner(n + 1).cross(corner(n + 2))) / 6;
  return volume_mm3;
}

TEST(BonePage, SimplifiedBallKeepsItsVolumeAndMoreDetailInTheSphere) {
  const BrickMesh whole = ball();
  const Sphere near{{0, 0, kRadius_mm}, 1};
  const BrickMesh simple = simplified(whole, whole.vertices.size() / 4, 0.2, near);
  EXPECT_LE(simple.vertices.size(), whole.vertices.size() / 4);
  const double true_mm3 = 4 * std::numbers::pi / 3 * std::pow(kRadius_mm, 3);
  EXPECT_NEAR(volume_mm3(whole), true_mm3, 0.01 * true_mm3);
  EXPECT_NEAR(volume_mm3(simple), true_mm3, 0.03 * true_mm3);
  std::size_t near_count = 0, far_count = 0;
  for (const MeshVertex& vertex : simple.vertices) {
    if (vertex.position_mm[2] > 3.5F) ++near_count;
    if (vertex.position_mm[2] < -3.5F) ++far_count;
  }
  EXPECT_GT(near_count, 2 * far_count);
  EXPECT_EQ(simplified(whole, whole.vertices.size(), 0.2, near).vertices.size(), whole.vertices.size());
}

TEST(BonePage, BodyStoresVerticesAsSixteenBitStepsOfItsBoundingBox) {
  const BrickMesh mesh = simplified(ball(), 500, 0.2, {{0, 0, 0}, 1});
  const nlohmann::json body = body_of({.name = "a", .choice = "b"}, mesh);
  EXPECT_NEAR(body["origin"][0].get<double>(), -kRadius_mm, 0.4);
  EXPECT_NEAR(body["step"].get<double>() * 65535, 2 * kRadius_mm, 0.4);
  EXPECT_EQ(body["places"].get<std::string>().size(), (mesh.vertices.size() * 6 + 2) / 3 * 4);
  EXPECT_EQ(body["triangles"].get<std::string>().size(), (mesh.indices.size() * 2 + 2) / 3 * 4);
  EXPECT_EQ(body["choice"], "b");
}

TEST(BonePage, IncludesTheWebGlScriptsOnlyIfThereAreBodies) {
  Page with, without;
  put_data(with, {{"bodies", nlohmann::json::array()}});
  put_data(without, {{"curves", nlohmann::json::array()}});
  EXPECT_EQ(with.scripts.size(), without.scripts.size() + 2);
  EXPECT_NE(with.scripts.front().find("WebGLRenderer"), std::string_view::npos);
}

}  // namespace
}  // namespace osteomill
