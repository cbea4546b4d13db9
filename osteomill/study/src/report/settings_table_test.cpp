#include <limits>

#include <gtest/gtest.h>

#include "report/report_parts.h"
#include "tests/support/report_samples.h"

namespace osteomill {
namespace {

using namespace testing_support;

std::string value_of(const Table& table, const std::string& key) {
  for (const auto& row : table.rows) {
    if (row[0].text() == key) return row[1].text();
  }
  return "(none)";
}

TEST(SettingsTable, ListsCommonValuesOnceAndDifferingValuesPerRun) {
  std::vector<Recording> runs = sample_runs(10);
  runs[3].description.settings.push_back({"only_here", std::string("<x>"), ""});
  for (Recording& run : runs) {
    run.description.settings.push_back({"felt", 26.057583387520594, ""});
    run.description.settings.push_back({"milling.law", 1.0, ""});
    run.description.settings.push_back({"spindle.handpiece", 0.0, ""});
    run.description.settings.push_back({"milling.drag", 0.0, ""});
    run.description.settings.push_back({"milling.wear", 1.0, ""});
    run.description.settings.push_back({"most", std::numeric_limits<double>::infinity(), ""});
    run.description.settings.push_back({"place", std::string("-0.0817525862,1,-0"), "mm"});
  }
  std::vector<const Recording*> recordings;
  for (const Recording& run : runs) recordings.push_back(&run);
  const Table table = settings_table(recordings);
  EXPECT_EQ(value_of(table, "push"), "1.5");
  EXPECT_EQ(value_of(table, "algorithm.stiffness"), "line-proxy: 2; surface-points: 20; point-shell: 2");
  EXPECT_EQ(value_of(table, "only_here"), "surface-points, holding: <x>");
  EXPECT_EQ(value_of(table, "command_line"), "(none)");
  EXPECT_EQ(value_of(table, "felt"), "26.0576");
  EXPECT_EQ(value_of(table, "most"), "no limit");
  EXPECT_EQ(value_of(table, "milling.law"), "chips");
  EXPECT_EQ(value_of(table, "spindle.handpiece"), "none");
  EXPECT_EQ(value_of(table, "milling.drag"), "off");
  EXPECT_EQ(value_of(table, "milling.wear"), "1");
  EXPECT_EQ(value_of(table, "place"), "-0.0817526, 1, 0");
}

std::vector<std::string> differing(std::vector<Recording>& runs) {
  std::vector<const Recording*> recordings;
  for (const Recording& run : runs) recordings.push_back(&run);
  const Table table = differences_table(recordings);
  EXPECT_EQ(table.rows.size(), table.header.size() == 1 ? 0 : runs.size());
  return {table.header.begin() + 1, table.header.end()};
}

TEST(DifferencesTable, HasAColumnForEachDifferingSetting) {
  std::vector<Recording> runs = sample_runs(10);
  EXPECT_EQ(differing(runs), std::vector<std::string>());
  runs[0].description.settings.push_back({std::string(kComparisonKey), std::string("a"), ""});
  EXPECT_EQ(differing(runs), std::vector<std::string>()) << "another comparison of the same";
  RunDescription& last = runs.back().description;
  last.seed = 2;
  last.tool.burr_radius_mm += 0.5;
  last.scan_hash = 1;
  last.tick_period_s = 0.002;
  for (RunSetting& setting : last.settings)
    if (setting.key == "push" || setting.key == "hand_stiffness") setting.value = 7.0;
  last.settings.push_back({"script.entry", std::string("1,2,3"), "mm"});
  EXPECT_EQ(differing(runs),
            std::vector<std::string>({"scan_hash", "burr_radius_mm", "seed", "tick_period_s", "push (N)",
                                      "hand_stiffness (N/m)", "script.entry (mm)"}));
}

TEST(DifferencesTable, ComparesAlgorithmSettingsOnlyWithinAnAlgorithm) {
  std::vector<Recording> runs = sample_runs(10);
  runs[1].description.settings.front().value = 3.0;
  EXPECT_EQ(differing(runs), std::vector<std::string>({"algorithm.stiffness (N/mm)"}));
}

}  // namespace
}  // namespace osteomill
