#include "app/scan_options.h"

#include <gtest/gtest.h>

namespace osteomill::app {
namespace {

ScanOptions all_set() {
  ScanOptions options;
  options.scan = "head.nrrd";
  options.isovalue = 300;
  options.read.series = "3.1";
  options.read.spacing_mm = Vec3(0.1, 0.2, 0.3);
  options.labels = {"bones.seg.nrrd", "colours.txt", {"nerve", "7"}};
  options.pieces = {.only_largest = true, .min_mm3 = 12.5};
  return options;
}

RunDescription run_on(const ScanOptions& options) {
  RunDescription run;
  run.scan_name = options.scan.empty() ? kBuiltinTooth : options.scan;
  run.isovalue = options.isovalue.value_or(0);
  run.settings = scan_settings(options);
  return run;
}

TEST(ScanOptions, RoundTripThroughARunDescription) {
  const ScanOptions was = all_set(), again = scan_of(run_on(was));
  EXPECT_EQ(was.scan, again.scan);
  EXPECT_EQ(was.isovalue, again.isovalue);
  for (const auto& field : fields_of<ScanOptions, std::string>())
    EXPECT_EQ(field.get(was), field.get(again)) << field.option;
  for (const auto& field : fields_of<ScanOptions>())
    EXPECT_EQ(field.get(was), field.get(again)) << field.option;
}

TEST(ScanOptions, GivenOptionsOverrideRecordedOnes) {
  ScanOptions given;
  given.scan = "moved/head.nrrd";
  given.labels.map = "moved/bones.seg.nrrd";
  const ScanOptions again = scan_of(run_on(all_set()), given);
  EXPECT_EQ("moved/head.nrrd", again.scan);
  EXPECT_EQ("moved/bones.seg.nrrd", again.labels.map);
  EXPECT_EQ("colours.txt", again.labels.table);
  EXPECT_TRUE(again.pieces.only_largest);
}

TEST(ScanOptions, UnsetOptionsAddNoSettings) {
  EXPECT_TRUE(scan_settings({}).empty());
  const ScanOptions again = scan_of(run_on({}));
  EXPECT_TRUE(again.scan.empty());
  EXPECT_TRUE(again.pieces.keeps_all());
}

}  // namespace
}  // namespace osteomill::app
