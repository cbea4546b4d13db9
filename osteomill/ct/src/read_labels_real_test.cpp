#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "osteomill/ct/read_labels.h"
#include "osteomill/ct/read_scan.h"

#include "tests/shared_data.h"

namespace osteomill {
namespace {

using testing_support::shared_data;

TEST(ReadLabelsReal, JawLabelCountsMatchInNrrdAndNifti) {
  OSTEOMILL_NEEDS_SHARED("jaw_labels");
  const auto nrrd = shared_data() / "jaw_labels/jaw_360x360x330_labels.nrrd";
  const GridGeometry scan = read_scan(nrrd).grid.geometry();
  const LabelsRead read = read_labels({nrrd, {}, {"5"}}, scan);
  ASSERT_EQ(read.map->labels().size(), 5u);
  EXPECT_TRUE(read.map->labels()[4].no_go);
  std::size_t labelled = 0;
  for (const std::size_t count : read.map->voxel_counts()) labelled += count;
  EXPECT_EQ(labelled, 1901286u);
  const auto nifti = shared_data() / "jaw_labels/PostDentalSurgery_Segmentation.nii.gz";
  const LabelsRead other = read_labels({nifti, {}, {}}, read_scan(nifti).grid.geometry());
  EXPECT_EQ(other.map->voxel_counts(), read.map->voxel_counts());
}

TEST(ReadLabelsReal, ReadsNamesOfAnExtensionOrAnItkSnapFile) {
  OSTEOMILL_NEEDS_SHARED("found4/23-nifti-kinds");
  const auto folder = shared_data() / "found4/23-nifti-kinds";
  const GridGeometry scan = read_scan(folder / "totalseg.nii.gz").grid.geometry();
  const LabelsRead own = read_labels({folder / "totalseg.nii.gz", {}, {}}, scan);
  ASSERT_EQ(own.map->labels().size(), 2u);
  EXPECT_EQ(own.map->labels()[0], (Label{26, "vertebrae_S1", {230, 230, 153}, false}));
  EXPECT_EQ(own.map->labels()[1], (Label{93, "rib_left_2", {102, 102, 230}, false}));
  const LabelsRead given = read_labels({folder / "totalseg.nii.gz", folder / "itksnap.txt", {}}, scan);
  EXPECT_EQ(given.map->labels()[0], (Label{26, "mandible left", {230, 230, 150}, false}));
  EXPECT_EQ(given.map->labels()[1].name, "canal");
}

TEST(ReadLabelsReal, TemporalBoneLabelCountsMatchTheFactsFile) {
  OSTEOMILL_NEEDS_SHARED("temporal_bone");
  const auto file = shared_data() / "temporal_bone/ear3_256_labels.nrrd";
  const auto facts = nlohmann::json::parse(std::ifstream(shared_data() / "temporal_bone/facts.json"));
  const LabelsRead read = read_labels({file, {}, {}}, read_scan(file).grid.geometry());
  const std::vector<std::size_t> counts = read.map->voxel_counts();
  const auto& expected = facts["ear3_256_labels.nrrd"]["label_counts"];
  ASSERT_FALSE(expected.is_null());
  for (std::size_t n = 0; n < read.map->labels().size(); ++n) {
    EXPECT_EQ(counts[n + 1],
              expected[static_cast<std::size_t>(read.map->labels()[n].value)].get<std::size_t>());
  }
}

}  // namespace
}  // namespace osteomill
