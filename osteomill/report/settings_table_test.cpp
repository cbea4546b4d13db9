#include "tests/support/report_samples.h"
#include <gtest/gtest.h>

#include "osteomill/report/report_parts.h"

namespace osteomill {
namespace {

using namespace testing_support;

std::string value_of(const HtmlTable& table, const std::string& key) {
  for (const auto& row : table.rows) {
    if (row[0] == key) return row[1];
  }
  return "(none)";
}

TEST(SettingsTable, SaysOnceWhatIsTheSameAndForEachWhatIsNot) {
  std::vector<Recording> runs = sample_runs(Mode::steady, 10);
  runs[3].description.settings.push_back({"only_here", std::string("<x>"), ""});
  std::vector<const Recording*> recordings;
  for (const Recording& run : runs) recordings.push_back(&run);
  const HtmlTable table = settings_table(recordings);
  EXPECT_EQ(value_of(table, "push"), "1.5");
  EXPECT_EQ(value_of(table, "stiffness"), "line-proxy: 2; surface-points: 20; point-shell: 2");
  EXPECT_EQ(value_of(table, "only_here"), "surface-points, steady, holding: &lt;x&gt;");
  EXPECT_EQ(value_of(table, "command_line"), "(none)");
}

}  // namespace
}  // namespace osteomill
