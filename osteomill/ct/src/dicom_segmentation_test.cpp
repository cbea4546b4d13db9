#include <gtest/gtest.h>

#include "osteomill/ct/read_labels.h"

#include "tests/shared_data.h"
#include "tests/support/folder_test.h"
#include "tests/support/generated_dicom.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

class DicomSegmentation : public testing_support::FolderTest {
 protected:
  void write_scan() const {
    for (int k = 0; k < 5; ++k)
      ASSERT_TRUE(
          save(*made_up_slice({.k = k}), folder_ / ("f" + std::to_string(k)), EXS_LittleEndianExplicit));
  }
};

TEST_F(DicomSegmentation, IsReadAsALabelMapWithNames) {
  ASSERT_TRUE(save(*made_up_segmentation(), folder_ / "seg", EXS_LittleEndianExplicit));
  const Scan scan = read_scan(folder_ / "seg");
  EXPECT_TRUE(scan.is_labels);
  const GridGeometry& geometry = scan.grid.geometry();
  EXPECT_EQ(geometry.dims, (std::array<int, 3>{kColumns, kRows, 4}));
  EXPECT_TRUE(geometry.spacing_mm.isApprox(Vec3(0.5, 0.25, 0.75), 1e-9));
  EXPECT_TRUE(geometry.origin_mm.isApprox(Vec3(1, 2, 10), 1e-9));
  for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
    EXPECT_EQ(scan.grid[v], segment_at(v.i, v.j, v.k)) << v.i << ' ' << v.j << ' ' << v.k;
  });
  ASSERT_EQ(scan.warnings.size(), 1U);
  EXPECT_TRUE(contains(scan.warnings[0], "voxels are in several segments"));
  ASSERT_EQ(scan.labels.size(), 2U);
  EXPECT_EQ(scan.labels[1].name,
            "Sch\xC3\xA4"
            "del");
  // White as CIELab in DICOM.
  EXPECT_EQ(scan.labels[1].colour, (std::array<std::uint8_t, 3>{255, 255, 255}));
}

TEST_F(DicomSegmentation, IsSkippedInAScanFolderButReadAsLabels) {
  write_scan();
  ASSERT_TRUE(save(*made_up_segmentation(), folder_ / "seg", EXS_LittleEndianExplicit));
  const Scan scan = read_scan(folder_);
  EXPECT_FALSE(scan.is_labels);
  EXPECT_EQ(scan.grid.geometry().dims[2], 5);
  EXPECT_TRUE(contains(scan.warnings.at(0), "1 segmentation left out; read it with --labels: seg"));
  const LabelsRead labels = read_labels({folder_ / "seg", "", {"mandible"}}, scan.grid.geometry());
  ASSERT_EQ(labels.map->labels().size(), 2U);
  EXPECT_EQ(labels.map->labels()[0].name, "mandible");
  EXPECT_TRUE(labels.map->labels()[0].no_go);
  for_each(scan.grid.geometry().all_voxels(), [&](const VoxelIndex& v) {
    EXPECT_EQ(labels.map->at(v), v.k < 4 ? segment_at(v.i, v.j, v.k) : 0);
  });
  EXPECT_THROW(read_labels({folder_ / "f1", "", {}}, scan.grid.geometry()), InputError);
}

TEST_F(DicomSegmentation, RefusesFramesOffTheGridAndTruncatedFiles) {
  for (const char* height : {"10.3", "1e9"}) {
    const auto file = made_up_segmentation(height);
    ASSERT_TRUE(save(*file, folder_ / "seg", EXS_LittleEndianExplicit));
    EXPECT_FALSE(refusal(folder_ / "seg").empty()) << height;
  }
  ASSERT_TRUE(save(*made_up_segmentation(), folder_ / "seg", EXS_LittleEndianExplicit));
  fs::resize_file(folder_ / "seg", fs::file_size(folder_ / "seg") - 4);
  EXPECT_TRUE(contains(refusal(folder_ / "seg"), "cut short"));
}

TEST_F(DicomSegmentation, ReadsTheMandibleOfASharedFile) {
  OSTEOMILL_NEEDS_SHARED("found4/28-dicom-seg/input.zip");
  const Scan scan = read_scan(shared_data() / "found4/28-dicom-seg/input.zip");
  EXPECT_EQ(scan.grid.geometry().dims, (std::array<int, 3>{40, 36, 24}));
  const LabelsRead labels = labels_in(scan, {});
  ASSERT_EQ(labels.map->labels().size(), 1U);
  EXPECT_EQ(labels.map->labels()[0].name, "mandible");
}

}  // namespace
}  // namespace osteomill
