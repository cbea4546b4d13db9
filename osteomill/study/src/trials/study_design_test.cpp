#include "osteomill/study/study_design.h"

#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

StudyAxis axis(const std::string& key, const std::vector<std::string>& values) {
  StudyAxis axis;
  for (const std::string& value : values) axis.push_back({{key, value}});
  return axis;
}

TEST(StudyDesign, GridCoversAllCombinationsWithFirstAxisSlowest) {
  const StudyDesign design(
      {{"seconds", "2"}}, {axis("algorithm", {"line-proxy", "barrier-shell"}), axis("push", {"1", "2", "4"})},
      {});
  ASSERT_EQ(design.trial_count(), 6u);
  EXPECT_EQ(design.varied(), (std::vector<std::string>{"algorithm", "push"}));
  EXPECT_EQ(design.trial(0), (StudySettings{{"seconds", "2"}, {"algorithm", "line-proxy"}, {"push", "1"}}));
  EXPECT_EQ(design.trial(4),
            (StudySettings{{"seconds", "2"}, {"algorithm", "barrier-shell"}, {"push", "2"}}));
  std::set<StudySettings> all;
  for (std::size_t n = 0; n < 6; ++n) all.insert(design.trial(n));
  EXPECT_EQ(all.size(), 6u);
}

TEST(StudyDesign, AxisVariesSeveralOptionsTogether) {
  const StudyAxis tools{{{"burr-radius", "1"}, {"shaft-radius", "0.5"}}, {{"burr-radius", "2"}}};
  const StudyDesign design({{"shaft-radius", "0.9"}}, {tools}, {});
  EXPECT_EQ(design.varied(), (std::vector<std::string>{"burr-radius", "shaft-radius"}));
  EXPECT_EQ(*find_value(design.trial(0), "shaft-radius"), "0.5");
  EXPECT_EQ(*find_value(design.trial(1), "shaft-radius"), "0.9");
  EXPECT_EQ(find_value(design.trial(1), "push"), nullptr);
}

// Each part of each range is in exactly one trial, in whatever order trials are requested.
TEST(StudyDesign, LatinHypercubeSamplesEachStratumOnce) {
  constexpr std::size_t kTrials = 50;
  const LatinHypercube hypercube{kTrials,
                                 7,
                                 {{"push", {0, 5, false}, {}},
                                  {"stiffness", {0.1, 10, true}, {}},
                                  {"algorithm", {}, axis("algorithm", {"line-proxy", "barrier-shell"})}}};
  const StudyDesign design({}, {axis("scan", {"a", "b"})}, hypercube);
  ASSERT_EQ(design.trial_count(), 2 * kTrials);
  std::set<int> pushes, stiffnesses;
  std::size_t ours = 0;
  for (std::size_t n = kTrials; n-- > 0;) {
    const StudySettings settings = design.trial(2 * n);
    pushes.insert(static_cast<int>(std::stod(*find_value(settings, "push")) / 5 * kTrials));
    const double decades = std::log10(std::stod(*find_value(settings, "stiffness")) / 0.1);
    stiffnesses.insert(static_cast<int>(decades / 2 * kTrials));
    ours += *find_value(settings, "algorithm") == "barrier-shell" ? 1 : 0;
    EXPECT_EQ(*find_value(settings, "push"), *find_value(design.trial(2 * n + 1), "push"));
  }
  EXPECT_EQ(pushes.size(), kTrials);
  EXPECT_EQ(stiffnesses.size(), kTrials);
  EXPECT_EQ(ours, kTrials / 2);
  LatinHypercube other = hypercube;
  other.seed = 8;
  EXPECT_NE(*find_value(StudyDesign({}, {}, other).trial(0), "push"), *find_value(design.trial(0), "push"));
}

TEST(StudyDesign, RefusesNoTrialsTooManyTrialsAndRepeatedOptions) {
  EXPECT_THROW(StudyDesign({}, {axis("push", {})}, {}), std::invalid_argument);
  EXPECT_THROW(StudyDesign({}, {}, {0, 1, {{"push", {0, 1, false}, {}}}}), std::invalid_argument);
  const StudyAxis thousand(1001, {{"push", "1"}});
  EXPECT_THROW(StudyDesign({}, {thousand, thousand, thousand}, {}), std::invalid_argument);
  EXPECT_THROW(StudyDesign({}, {axis("push", {"1"}), axis("push", {"2"})}, {}), std::invalid_argument);
  EXPECT_THROW(steps_of({0, 1, false}, 0), std::invalid_argument);
}

TEST(StudyDesign, StepsSpanTheRangeExactly) {
  EXPECT_EQ(steps_of({1, 3, false}, 3), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(steps_of({2, 3, false}, 1), (std::vector<double>{2}));
  const std::vector<double> seeds = steps_of({1, 10000, false}, 10000);
  for (std::size_t n = 0; n < seeds.size(); ++n) ASSERT_EQ(seeds[n], static_cast<double>(n + 1));
  EXPECT_EQ(steps_of({0.25, 16, true}, 7), (std::vector<double>{0.25, 0.5, 1, 2, 4, 8, 16}));
  EXPECT_EQ(steps_of({0.1, 0.7, false}, 7), (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}));
  const std::vector<double> decades = steps_of({0.01, 100, true}, 5);
  EXPECT_NEAR(decades[2], 1, 1e-12);
  EXPECT_EQ(decades.back(), 100);
}

TEST(StudyDesign, SeedDefaultsToOne) {
  EXPECT_EQ(seed_of({{"seed", "13"}}), 13u);
  EXPECT_EQ(seed_of({}), 1u);
}

}  // namespace
}  // namespace osteomill
