#include "osteomill/ct/write_nrrd.h"

#include <algorithm>
#include <string>

#include <Eigen/Geometry>

#include "tests/shared_data.h"
#include "tests/support/folder_test.h"

namespace osteomill {
namespace {

using WriteNrrd = testing_support::FolderTest;

GridGeometry oblique_frame(bool mirrored) {
  GridGeometry geometry;
  geometry.dims = {7, 5, 6};
  geometry.spacing_mm = {0.3, 1.0 / 3, 0.7};
  geometry.origin_mm = {-123.456, 78.9, 1e-3};
  geometry.direction = Eigen::AngleAxisd(0.4, Vec3(3, -1, 2).normalized()).toRotationMatrix();
  if (mirrored) geometry.direction.col(2) *= -1;
  return geometry;
}

DensityGrid numbered(const GridGeometry& geometry, float first, float step) {
  std::vector<float> densities(geometry.voxel_count());
  for (std::size_t n = 0; n < densities.size(); ++n) densities[n] = first + step * static_cast<float>(n);
  return DensityGrid(geometry, densities);
}

void expect_same(const DensityGrid& a, const DensityGrid& b) {
  EXPECT_EQ(a.geometry().dims, b.geometry().dims);
  EXPECT_EQ(a.densities(), b.densities());
  EXPECT_LT((a.geometry().spacing_mm - b.geometry().spacing_mm).norm(), 1e-12);
  EXPECT_LT((a.geometry().origin_mm - b.geometry().origin_mm).norm(), 1e-12);
  EXPECT_LT((a.geometry().direction - b.geometry().direction).norm(), 1e-12);
}

std::string type_in(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line) && !line.starts_with("type: ")) {
  }
  return line.substr(6);
}

TEST_F(WriteNrrd, RoundTripsFrameAndValuesInTheSmallestType) {
  const std::filesystem::path path = folder_ / "out.nrrd";
  for (const bool mirrored : {false, true}) {
    const GridGeometry frame = oblique_frame(mirrored);
    for (const auto& [first, step, type] : {std::tuple{-1000.0f, 13.0f, "short"},
                                            {30000.0f, 100.0f, "ushort"},
                                            {-1000.0f, 1000.0f, "float"},
                                            {0.1f, 0.37f, "float"}}) {
      const DensityGrid grid = numbered(frame, first, step);
      write_nrrd(path, grid);
      EXPECT_EQ(type_in(path), type);
      const Scan scan = read_scan(path);
      expect_same(scan.grid, grid);
      EXPECT_TRUE(scan.warnings.empty());
    }
  }
}

// More data than the writer compresses at once.
TEST_F(WriteNrrd, RoundTripsALargeGrid) {
  GridGeometry geometry;
  geometry.dims = {101, 67, 53};
  std::vector<float> densities(geometry.voxel_count());
  unsigned random = 1;
  for (float& density : densities) {
    random = random * 1664525u + 1013904223u;
    density = static_cast<float>(random) / 7.0f;
  }
  const DensityGrid grid(geometry, densities);
  write_nrrd(folder_ / "out.nrrd", grid);
  expect_same(read_scan(folder_ / "out.nrrd").grid, grid);
}

TEST_F(WriteNrrd, RoundTripsScansOfUnusualOrientation) {
  OSTEOMILL_NEEDS_SHARED("volumes_odd/nrrd");
  for (const char* name : {"rotated.nrrd", "flipped_axis.nrrd", "permuted_axes.nrrd", "space_ras.nrrd"}) {
    const Scan scan = read_scan(testing_support::shared_data() / "volumes_odd/nrrd" / name);
    write_nrrd(folder_ / name, scan.grid);
    expect_same(read_scan(folder_ / name).grid, scan.grid);
  }
}

TEST_F(WriteNrrd, NamesAFileThatCannotBeWritten) {
  EXPECT_THROW(write_nrrd(folder_ / "none" / "out.nrrd", numbered(oblique_frame(false), 0, 1)), InputError);
}

}  // namespace
}  // namespace osteomill
