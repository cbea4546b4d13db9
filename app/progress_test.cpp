#include "app/progress.h"

#include <vector>

#include <gtest/gtest.h>

namespace osteomill::app {
namespace {

// Returns the lines of a task that progresses evenly and reports each second.
std::vector<std::string> lines_of(double seconds, double fraction_per_s) {
  ProgressText text;
  std::vector<std::string> lines;
  for (int n = 0; n <= seconds; ++n) {
    const std::string line = text.at("compare", fraction_per_s * n, 1e5 + n);
    if (!line.empty() && text.claim_line()) lines.push_back(line);
  }
  return lines;
}

TEST(ProgressText, PrintsALinePerTenPercentOfQuickWork) {
  const std::vector<std::string> lines = lines_of(100, 0.01);
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines[0], "compare  10 %, 1 min 30 s left");
  EXPECT_EQ(lines[9], "compare 100 %, 0 s left");
}

TEST(ProgressText, PrintsALinePerMinuteOfSlowWork) {
  const std::vector<std::string> lines = lines_of(300, 1e-4);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0], "compare   1 %, 2 h 45 min left");
}

TEST(ProgressText, RestartsSilentlyForNewOrRepeatedWork) {
  ProgressText text;
  EXPECT_EQ(text.at("a", 0.5, 10), "");
  EXPECT_EQ(text.at("a", 0.5, 20), "a  50 %, 10 s left");
  EXPECT_EQ(text.at("b", 0.5, 21), "");
  EXPECT_EQ(text.at("b", 0.5, 23), "b  50 %, 2 s left");
  EXPECT_EQ(text.at("b", 0.25, 24), "") << "the same work once more";
}

}  // namespace
}  // namespace osteomill::app
