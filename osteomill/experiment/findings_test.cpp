#include "osteomill/experiment/findings.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/files/input_error.h"
#include "osteomill/haptics/algorithms.h"

namespace osteomill {
namespace {

Recording short_run(std::string_view algorithm, std::string_view phase) {
  Recording recording;
  recording.path = std::string(algorithm) + ".h5";
  recording.description.algorithm = algorithm_named(algorithm).id;
  recording.description.segment = phase;
  recording.records.resize(2);
  recording.records[0].time_s = phase == kHolding ? 20 : 0;
  recording.records[1].time_s = recording.records[0].time_s + 0.001;
  return recording;
}

// Figures are set by hand: what is tested is the rules.
class FindingsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const std::string_view phase : kPhases) {
      for (const std::string_view algorithm : kPapersAlgorithms)
        recordings_.push_back(short_run(algorithm, phase));
    }
    group_ = group_runs(recordings_).at(0);
    for (MeasuredRun& run : group_.runs) run.metrics.rate_hz = 980;
    set(kMilling, {0.02, 0.13, 0.01}, {0.8, 0.5, 0.4}, {14, 2, 1}, {0.9, 0.6, 0.3});
    set(kHolding, {0.02, 0.13, 0.01}, {0.8, 0.5, 0.1}, {1, 2, 0.5}, {0.9, 0.6, 0.3});
  }

  RunMetrics& metrics(std::string_view algorithm, std::string_view phase) {
    return const_cast<RunMetrics&>(group_.find(algorithm, phase)->metrics);
  }
  void set(std::string_view phase, const Vec3& force_hp, const Vec3& torque_hp, const Vec3& torque_step,
           const Vec3& spread) {
    for (int n = 0; n < 3; ++n) {
      RunMetrics& m = metrics(kPapersAlgorithms[static_cast<std::size_t>(n)], phase);
      m.force_N.hp_rms = force_hp[n];
      m.torque_Nmm.hp_rms = torque_hp[n];
      m.torque_Nmm.step_max = torque_step[n];
      m.shaft.spread_deg = spread[n];
    }
  }
  std::vector<std::string> disagreeing() const {
    std::vector<std::string> names;
    for (const Finding& f : check_findings(group_)) {
      if (f.verdict == Verdict::does_not_agree) names.push_back(f.paper_says);
    }
    return names;
  }

  std::vector<Recording> recordings_;
  RunGroup group_;
};

TEST_F(FindingsTest, WhatThePaperFoundAgrees) {
  EXPECT_TRUE(disagreeing().empty());
  EXPECT_EQ(check_findings(group_).size(), 10u);
}

TEST_F(FindingsTest, WhoLostContactIsNeitherBestNorWorst) {
  RunMetrics& m = metrics("surface-points", kHolding);
  m.contact.any = m.contact.force = 0.05;
  m.contact.lost_after_s = 3.2;
  m.force_N.hp_rms = m.torque_Nmm.hp_rms = m.shaft.spread_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(disagreeing().empty());
  const std::vector<Finding> findings = check_findings(group_);
  EXPECT_EQ(std::count_if(findings.begin(), findings.end(),
                          [](const Finding& f) { return f.verdict == Verdict::lost_contact; }),
            4);
  for (const Finding& f : findings) {
    EXPECT_EQ(f.measured.find("nan"), std::string::npos) << f.measured;
    EXPECT_EQ(f.measured.find("lost contact after 3.2 s") != std::string::npos,
              f.verdict == Verdict::lost_contact)
        << f.measured;
  }
}

TEST_F(FindingsTest, EachRuleCanFail) {
  using S = std::vector<std::string>;
  metrics("point-shell", kHolding).rate_hz = 949;
  EXPECT_EQ(disagreeing(), S{"Every algorithm holds the haptic rate"});
  metrics("point-shell", kHolding).rate_hz = 950;
  EXPECT_EQ(disagreeing(), S{});

  metrics("surface-points", kMilling).force_N.hp_rms = 0.039;
  EXPECT_EQ(disagreeing(), S{"Force while milling: 1 and 3 are steady, 2 buzzes"});
  metrics("surface-points", kMilling).force_N.hp_rms = 0.041;

  metrics("surface-points", kHolding).torque_Nmm.hp_rms = 0.9;
  EXPECT_EQ(disagreeing(), S{"Torque while holding: 1 is the worst, 2 is better"});
  metrics("surface-points", kHolding).torque_Nmm.hp_rms = 0.5;

  metrics("point-shell", kMilling).torque_Nmm.step_max = 15;
  EXPECT_EQ(disagreeing(), S{"Torque while milling: the shaft is kicked away in 1, with a peak"});
  metrics("point-shell", kMilling).torque_Nmm.step_max = 1;

  metrics("point-shell", kMilling).torque_Nmm.hp_rms = 0.14;
  EXPECT_EQ(disagreeing(), S{"Torque of 3: a little restless while milling"});
  metrics("point-shell", kMilling).torque_Nmm.hp_rms = 0.4;

  metrics("surface-points", kHolding).shaft.spread_deg = 0.2;
  EXPECT_EQ(disagreeing(), S{"Shaft direction while holding: 3 is the most compact"});
}

TEST_F(FindingsTest, WhatWasNotRecordedIsNotJudged) {
  const auto gone = [](const MeasuredRun& run) {
    return run.recording->description.algorithm == "surface-points";
  };
  group_.runs.erase(std::remove_if(group_.runs.begin(), group_.runs.end(), gone), group_.runs.end());
  const auto findings = check_findings(group_);
  const auto count = std::count_if(findings.begin(), findings.end(),
                                   [](const Finding& f) { return f.verdict == Verdict::not_recorded; });
  // All but the rate and 3 against itself.
  EXPECT_EQ(count, 8);
}

TEST(GroupRuns, TwoOfAKindAreRefusedAndNamed) {
  std::vector<Recording> recordings{short_run("line-proxy", kMilling), short_run("line-proxy", kMilling)};
  recordings[1].path = "again.h5";
  try {
    group_runs(recordings);
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.starts_with("again.h5: is line-proxy, steady, milling as line-proxy.h5 is")) << what;
  }
  recordings[1].description.mode = Mode::paper;
  const auto groups = group_runs(recordings);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].mode, Mode::paper);
  EXPECT_THROW(group_runs({}), InputError);
}

}  // namespace
}  // namespace osteomill
