#include <filesystem>

#include <gtest/gtest.h>

#include "osteomill/base/temporary_folder.h"

#include "report/report_parts.h"
#include "tests/support/report_samples.h"

namespace osteomill {
namespace {

using testing_support::sample_run;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(LabelSection, ListsTheCutVolumeOfEachLabelWithNoGoFirst) {
  std::vector<Recording> runs{sample_run("point-shell", "milling", 4000)};
  EXPECT_FALSE(label_section(group_runs(runs)));
  runs[0].description.labels = {
      {1, "bone", {255, 0, 0}}, {2, "<nerve>", {0, 0, 255}, true}, {3, "other", {}}};
  EXPECT_TRUE(contains(html(*label_section(group_runs(runs))), "cut no labelled bone"));
  for (std::size_t n = 2000; n < 3000; ++n) {
    runs[0].records[n].dt_s = 1e-3;
    runs[0].records[n].label_cuts = {LabelCut{1, 0.001}, LabelCut{2, 0.0005}};
  }
  const RunGroup group = group_runs(runs);
  const std::string page = html(*label_section(group));
  EXPECT_TRUE(contains(page, "</span> bone"));
  EXPECT_TRUE(contains(page, "&lt;nerve&gt; <span class=\"differs\">no-go</span>"));
  EXPECT_LT(page.find("nerve"), page.find("</span> bone"));
  EXPECT_TRUE(contains(page, ">1.000<"));
  EXPECT_TRUE(contains(page, ">0.500<"));
  EXPECT_TRUE(contains(page, ">2.00<"));
  EXPECT_TRUE(contains(page, "#ff0000"));
  EXPECT_FALSE(contains(page, "other"));
  const TemporaryFolder folder;
  const auto figure = draw_label_figure(group, folder.path());
  ASSERT_TRUE(figure);
  EXPECT_TRUE(std::filesystem::exists(figure->svg));
}

}  // namespace
}  // namespace osteomill
