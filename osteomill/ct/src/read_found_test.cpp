// Scans modelled on public bug reports, stored next to the checkout. Unless noted, each is the same phantom.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/ct/read_scan.h"

#include "tests/shared_data.h"

namespace osteomill {
namespace {

using testing_support::shared_data;

struct Found {
  const char* file;
  /// Slice distance of the phantom; x and y are 0.4 mm unless they equal z's digits.
  double slice_distance_mm = 0.5;
  /// Part of one of the warnings; empty if there are none.
  const char* warning = "";
  const char* series = "";
  double origin_z_mm = 3;
};

class FoundScan : public ::testing::TestWithParam<Found> {};

TEST_P(FoundScan, MatchesThePhantom) {
  const Found& found = GetParam();
  const std::string path = std::string("found4/") + found.file;
  OSTEOMILL_NEEDS_SHARED(path);
  const Scan scan = read_scan(shared_data() / path, {.series = found.series});
  const GridGeometry& geometry = scan.grid.geometry();
  EXPECT_EQ(geometry.dims, (std::array<int, 3>{40, 36, 24}));
  EXPECT_NEAR(geometry.spacing_mm.z(), found.slice_distance_mm, 0.0023);
  EXPECT_TRUE(geometry.origin_mm.isApprox(Vec3(-8, -7, found.origin_z_mm), 1e-6));
  const std::vector<float> densities = every_nth_density(scan.grid, 1);
  const auto [min, max] = std::minmax_element(densities.begin(), densities.end());
  EXPECT_EQ(*min, -1000);
  EXPECT_EQ(*max, 1161);
  EXPECT_EQ(std::count_if(densities.begin(), densities.end(), [](float density) { return density > 260; }),
            2420);
  std::string warnings;
  for (const std::string& warning : scan.warnings) warnings += warning + "\n";
  EXPECT_NE(warnings.find(found.warning), std::string::npos) << warnings;
  EXPECT_EQ(warnings.empty(), std::string(found.warning).empty()) << warnings;
}

INSTANTIATE_TEST_SUITE_P(
    ReadFound, FoundScan,
    ::testing::Values(Found{"04-two-acquisitions/half-a-slice-off.zip", 0.5, "1.2 (acquisition 2)"},
                      Found{"04-two-acquisitions/half-a-slice-off.zip", 0.5, "", "1.2", 3.25},
                      Found{"04-two-acquisitions/same-places.zip", 0.5, "1.2 (acquisition 2)"},
                      Found{"04-two-acquisitions/same-places.zip", 0.5, "", "1.2"},
                      Found{"07-copies/same-pixels.zip", 0.5, "3 copies"},
                      Found{"08-odd-one/size.zip", 0.5, "zz.dcm, of another size"},
                      Found{"03-multiframe-cbct/ct-class.dcm", 0.5, "no positions of their own"},
                      Found{"12-mislabelled/implicit-said-explicit.zip"}, Found{"09-float-pixels/all.zip"},
                      Found{"30-padding/high.zip"}, Found{"14-enhanced-parts/two.zip"},
                      Found{"15-dynamic/files.zip", 0.5, "1.2 ("},
                      Found{"15-dynamic/files.zip", 0.5, "", "1.3"},
                      Found{"18-rounded-positions/0.15mm-1digits.zip", 0.1478, "rounded to 0.1 mm"},
                      Found{"18-rounded-positions/0.25mm-1digits.zip", 0.25, "rounded to 0.1 mm"},
                      Found{"18-rounded-positions/0.4mm-0digits.zip", 0.3913, "rounded to 1 mm"}));

struct Refused {
  const char* file;
  const char* reason;
};
class FoundRefusal : public ::testing::TestWithParam<Refused> {};

TEST_P(FoundRefusal, StatesTheReason) {
  const auto& [file, reason] = GetParam();
  const std::string path = std::string("found4/") + file;
  OSTEOMILL_NEEDS_SHARED(path);
  try {
    read_scan(shared_data() / path);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(ReadFound, FoundRefusal,
                         ::testing::Values(Refused{"27-only-localizers/all.zip", "only 2 localizers"},
                                           Refused{"10-syntax/jpegxl.zip", "JPEG XL lossless (1.2.840"}));

TEST(ReadFound, HighThroughputJpeg2000HasItsMinMaxAndMean) {
  OSTEOMILL_NEEDS_SHARED("found4/10-syntax/htj2k");
  const Scan scan = read_scan(shared_data() / "found4/10-syntax/htj2k");
  struct Slice {
    double min;
    double max;
    double mean;
  };
  // In order of position, which need not be the order of the files.
  const std::array<Slice, 2> slices{{{-2000, 2278, 152.6963}, {-2048, 1433, -754.2929}}};
  const auto& dims = scan.grid.geometry().dims;
  ASSERT_EQ(dims, (std::array<int, 3>{512, 512, 2}));
  for (int k = 0; k < 2; ++k) {
    double min = 1e9, max = -1e9, sum = 0;
    for (int j = 0; j < dims[1]; ++j) {
      for (const float density : scan.grid.row(j, k)) {
        min = std::min(min, static_cast<double>(density));
        max = std::max(max, static_cast<double>(density));
        sum += static_cast<double>(density);
      }
    }
    const Slice& expected = slices[max == slices[0].max ? 0 : 1];
    EXPECT_EQ(min, expected.min);
    EXPECT_EQ(max, expected.max);
    EXPECT_NEAR(sum / (512 * 512), expected.mean, 1e-4);
  }
}

TEST(ReadFound, DescriptionsAreUtf8WithoutControlCharacters) {
  OSTEOMILL_NEEDS_SHARED("found4/19-characters/latin1.zip");
  const std::string latin = read_scan(shared_data() / "found4/19-characters/latin1.zip").series.at(0);
  EXPECT_NE(latin.find("\"Sch\xC3\xA4"
                       "del axial Knochen\""),
            std::string::npos)
      << latin;
  for (const std::string& line : read_scan(shared_data() / "found4/19-characters/terminal.zip").series) {
    EXPECT_NE(line.find("\"?]0;owned??[31mred?[2J\""), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace osteomill
