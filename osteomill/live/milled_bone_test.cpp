#include "osteomill/live/milled_bone.h"

#include <fstream>
#include <iterator>
#include <limits>
#include <memory>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

// Sides of 21 voxels: the last bricks reach beyond the grid.
Volume small_ball() {
  return shape_volume(centred_cube(21, 0.5), ball(Vec3::Zero(), 4));
}

MilledBone sample() {
  const Volume bone = small_ball();
  MilledBone milled{"/scans/a \"b\"\n c",
                    "1.2.3",
                    "/scans/a.seg.nrrd",
                    "",
                    {"facial nerve", "7"},
                    "a b",
                    1.0 / 3,
                    2.5,
                    bone.geometry().dims,
                    fingerprint_of(bone.grid()),
                    {}};
  for (const VoxelIndex& first : {VoxelIndex{8, 8, 8}, VoxelIndex{16, 0, 16}}) {
    milled.bricks.emplace_back(bone.grid(), first);
    milled.bricks.back().densities[3] = -0.125f;
  }
  return milled;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(MilledBone, ComesBackAsItWas) {
  const TemporaryFolder folder;
  const MilledBone milled = sample();
  write_milled_bone(folder / "a.milled", milled);
  const MilledBone read = read_milled_bone(folder / "a.milled");
  EXPECT_EQ(read.scan, milled.scan);
  EXPECT_EQ(read.series, milled.series);
  EXPECT_EQ(read.labels, milled.labels);
  EXPECT_EQ(read.label_table, milled.label_table);
  EXPECT_EQ(read.no_go, milled.no_go);
  EXPECT_EQ(read.name, milled.name);
  EXPECT_EQ(read.isovalue, milled.isovalue);
  EXPECT_EQ(read.removed_mm3, milled.removed_mm3);
  EXPECT_EQ(read.dims, milled.dims);
  EXPECT_EQ(read.fingerprint, milled.fingerprint);
  ASSERT_EQ(read.bricks.size(), milled.bricks.size());
  for (std::size_t n = 0; n < read.bricks.size(); ++n) {
    EXPECT_EQ(read.bricks[n].first, milled.bricks[n].first);
    EXPECT_EQ(read.bricks[n].densities, milled.bricks[n].densities);
  }
  EXPECT_TRUE(read_milled_bone_facts(folder / "a.milled").bricks.empty());
}

TEST(MilledBone, NothingButAWholeFileIsRead) {
  const TemporaryFolder folder;
  write_milled_bone(folder / "whole", sample());
  const std::string whole = bytes_of(folder / "whole");
  for (std::size_t length = 0; length < whole.size(); length += length < 200 ? 1 : 97) {
    std::ofstream(folder / "cut", std::ios::binary) << whole.substr(0, length);
    EXPECT_THROW(read_milled_bone(folder / "cut"), InputError) << length;
  }
  std::ofstream(folder / "longer", std::ios::binary) << whole << 'x';
  EXPECT_THROW(read_milled_bone(folder / "longer"), InputError);
  EXPECT_THROW(read_milled_bone(folder / "none"), InputError);
  EXPECT_THROW(read_milled_bone(folder.path()), InputError);
}

TEST(MilledBone, WhatNoBoneCanHaveIsRefused) {
  const TemporaryFolder folder;
  const auto refused = [&](const MilledBone& milled) {
    write_milled_bone(folder / "a", milled);
    EXPECT_THROW(read_milled_bone(folder / "a"), InputError);
  };
  MilledBone milled = sample();
  milled.bricks[0].densities[7] = std::numeric_limits<float>::quiet_NaN();
  refused(milled);
  for (const VoxelIndex& first : {VoxelIndex{-8, 0, 0}, VoxelIndex{24, 0, 0}, VoxelIndex{4, 0, 0}}) {
    milled = sample();
    milled.bricks[1].first = first;
    refused(milled);
  }
}

TEST(MilledBone, BelongsToItsScanAlone) {
  Volume bone = small_ball();
  MilledBone read = sample();
  EXPECT_NO_THROW(require_same_scan(sample(), read));
  bone.lower_density({10, 10, 10}, 1);
  read.fingerprint = fingerprint_of(bone.grid());
  EXPECT_THROW(require_same_scan(sample(), read), InputError);
  read = sample();
  std::swap(read.dims[0], --read.dims[1]);
  EXPECT_THROW(require_same_scan(sample(), read), InputError);
}

}  // namespace
}  // namespace osteomill
