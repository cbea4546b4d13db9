#include "osteomill/visual/mesh_file.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"

#include "tests/shapes.h"
#include "tests/support/mesh_checks.h"

namespace osteomill {
namespace {

using testing_support::enclosed_volume_mm3;

// A ball far from the origin in an oblique, left-handed frame.
BrickMesh far_ball() {
  GridGeometry geometry = testing_support::centred_cube(30, 0.2);
  geometry.direction = Eigen::AngleAxisd(0.3, Vec3(1, 1, 2).normalized()).toRotationMatrix();
  geometry.direction.col(0) *= -1;
  geometry.origin_mm = {-210, 150, 400};
  const Vec3 centre = geometry.world_from_voxel(Vec3(15, 14, 15));
  return mesh_in_one_piece(
      DensityView(testing_support::shape_volume(geometry, testing_support::ball(centre, 2))));
}

std::string written(const BrickMesh& mesh, const std::string& name, const LabelMap* labels = nullptr) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / ("osteomill_mesh_file_" + name);
  write_mesh(path, mesh, labels);
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::filesystem::remove(path);
  return bytes;
}

template <typename Value>
Value take(const std::string& bytes, std::size_t& at) {
  Value value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

TEST(MeshFile, StlHoldsTheTrianglesAndTheirNormals) {
  const BrickMesh mesh = far_ball();
  const std::string bytes = written(mesh, "a.stl");
  EXPECT_NE(bytes.substr(0, 5), "solid");  // would mark an ASCII file
  EXPECT_NE(bytes.substr(0, 80).find("SPACE=LPS"), std::string::npos);
  std::size_t at = 80;
  ASSERT_EQ(take<std::uint32_t>(bytes, at), mesh.triangle_count());
  ASSERT_EQ(bytes.size(), 84 + 50 * mesh.triangle_count());
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const auto normal = take<std::array<float, 3>>(bytes, at);
    const auto corners = take<std::array<std::array<float, 3>, 3>>(bytes, at);
    take<std::uint16_t>(bytes, at);
    for (std::size_t c = 0; c < 3; ++c) {
      const MeshVertex& vertex = mesh.vertices[mesh.indices[n + c]];
      EXPECT_EQ(corners[c], vertex.position_mm);
      EXPECT_GT(Vec3(normal[0], normal[1], normal[2]).dot(testing_support::normal_of(vertex)), 0.3);
    }
  }
}

TEST(MeshFile, PlyHoldsVerticesNormalsDensitiesAndTriangles) {
  const BrickMesh mesh = far_ball();
  const std::string bytes = written(mesh, "a.PLY");
  std::size_t at = bytes.find("end_header\n") + 11;
  const std::string header = bytes.substr(0, at);
  EXPECT_NE(header.find("element vertex " + std::to_string(mesh.vertices.size()) + "\n"), std::string::npos);
  EXPECT_NE(header.find("element face " + std::to_string(mesh.triangle_count()) + "\n"), std::string::npos);
  BrickMesh read;
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) read.vertices.push_back(take<MeshVertex>(bytes, at));
  for (std::size_t n = 0; n < mesh.triangle_count(); ++n) {
    EXPECT_EQ(take<std::uint8_t>(bytes, at), 3);
    for (int c = 0; c < 3; ++c) read.indices.push_back(take<std::uint32_t>(bytes, at));
  }
  EXPECT_EQ(at, bytes.size());
  EXPECT_EQ(read, mesh);
}

TEST(MeshFile, ObjReadsBackExactly) {
  const BrickMesh mesh = far_ball();
  std::istringstream in(written(mesh, "a.obj"));
  BrickMesh read;
  std::size_t normals = 0;
  std::string word;
  std::getline(in, word);
  while (in >> word) {
    std::array<float, 3> numbers{};
    if (word == "f") {
      for (int c = 0; c < 3; ++c) {
        std::uint32_t position = 0, normal = 0;
        char slash = 0;
        in >> position >> slash >> slash >> normal;
        EXPECT_EQ(position, normal);
        read.indices.push_back(position - 1);
      }
      continue;
    }
    for (float& number : numbers) in >> number;
    if (word == "v") read.vertices.push_back({numbers, {}, 0});
    if (word == "vn") {
      EXPECT_EQ(numbers, mesh.vertices[normals++].normal);
    }
  }
  EXPECT_EQ(normals, mesh.vertices.size());
  EXPECT_EQ(read.indices, mesh.indices);
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    EXPECT_EQ(read.vertices[n].position_mm, mesh.vertices[n].position_mm);
  }
  EXPECT_GT(enclosed_volume_mm3(read), 33);
}

// A ball of 2 mm radius whose half with x > 0 is labelled.
struct HalfLabelled {
  GridGeometry grid = testing_support::centred_cube(24, 0.25);
  BrickMesh mesh = mesh_in_one_piece(
      DensityView(testing_support::shape_volume(grid, testing_support::ball(Vec3::Zero(), 2))));
  LabelMap labels = {{{7, "crown", {0, 51, 255}, false}}, grid, grid, places()};

  std::vector<LabelMap::LabelIndex> places() const {
    std::vector<LabelMap::LabelIndex> places(grid.voxel_count());
    for (std::size_t n = 0; n < places.size(); ++n) places[n] = n % 24 < 12 ? 0 : 1;
    return places;
  }
};

TEST(MeshFile, PlyHoldsColourAndValueOfTheLabelUnderEachVertex) {
  const auto& [grid, mesh, labels] = HalfLabelled();
  const std::string bytes = written(mesh, "b.ply", &labels);
  std::size_t at = bytes.find("end_header\n") + 11;
  EXPECT_NE(bytes.find("uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label\n"),
            std::string::npos);
  for (const MeshVertex& vertex : mesh.vertices) {
    EXPECT_EQ(take<MeshVertex>(bytes, at), vertex);
    const auto colour = take<std::array<std::uint8_t, 3>>(bytes, at);
    const auto value = take<std::int32_t>(bytes, at);
    EXPECT_EQ(colour == labels.label(1).colour, value == 7);
    // Near the border the label under the surface counts, not the nearest voxel's.
    if (std::abs(vertex.position_mm[0]) > 0.6f) {
      EXPECT_EQ(value, vertex.position_mm[0] > 0 ? 7 : 0);
    }
  }
  EXPECT_EQ(bytes.size(), at + 13 * mesh.triangle_count());
}

TEST(MeshFile, ObjHoldsLabelColourOfEachVertex) {
  const auto& [grid, mesh, labels] = HalfLabelled();
  std::istringstream in(written(mesh, "b.obj", &labels));
  std::string line;
  std::getline(in, line);
  for (const MeshVertex& vertex : mesh.vertices) {
    std::getline(in, line);
    const bool crown = line.ends_with(" 0 0.2 1");
    if (std::abs(vertex.position_mm[0]) > 0.6f) {
      EXPECT_EQ(crown, vertex.position_mm[0] > 0) << line;
    }
  }
  std::getline(in, line);
  EXPECT_TRUE(line.starts_with("vn ")) << line;
}

// Programs that merge vertices by position, as all STL readers do, get the same closed surface.
TEST(MeshFile, VerticesFarFromOriginStayDistinct) {
  const BrickMesh mesh = far_ball();
  std::map<std::array<float, 3>, int> positions;
  for (const MeshVertex& vertex : mesh.vertices) ++positions[vertex.position_mm];
  EXPECT_EQ(positions.size(), mesh.vertices.size());
}

TEST(MeshFile, RefusesUnknownFormatsAndUnwritablePaths) {
  const BrickMesh mesh = far_ball();
  EXPECT_THROW(write_mesh("a.vtk", mesh), InputError);
  EXPECT_THROW(write_mesh("stl", mesh), InputError);
  EXPECT_THROW(write_mesh("/nowhere/at/all.stl", mesh), InputError);
}

}  // namespace
}  // namespace osteomill
