#include "osteomill/study/findings.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/paper.h"

namespace osteomill {
namespace {

Recording short_run(std::string_view algorithm, std::string_view phase) {
  Recording recording;
  recording.path = std::string(algorithm) + ".h5";
  recording.description.algorithm = algorithm_named(algorithm).id;
  recording.description.phase = phase;
  recording.records.resize(2);
  recording.records[0].time_s = phase == kHolding ? 20 : 0;
  recording.records[1].time_s = recording.records[0].time_s + 0.001;
  return recording;
}

// Figures are set by hand, to test only the rules.
class FindingsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const std::string_view phase : kPhases) {
      for (const std::string_view algorithm : kPapersAlgorithms)
        recordings_.push_back(short_run(algorithm, phase));
    }
    group_ = group_runs(recordings_);
    for (MeasuredRun& run : group_.runs) run.metrics.rate_hz = 980;
    set(kMilling, {0.02, 0.13, 0.01}, {0.8, 0.5, 0.4}, {14, 2, 1}, {0.9, 0.6, 0.3});
    set(kHolding, {0.02, 0.13, 0.01}, {0.8, 0.5, 0.1}, {1, 2, 0.5}, {0.9, 0.6, 0.3});
    RunMetrics& kicking = metrics("line-proxy", kMilling);
    kicking.turns = {20, 9};
  }

  RunMetrics& metrics(std::string_view algorithm, std::string_view phase) {
    return const_cast<RunMetrics&>(group_.find(algorithm, phase)->metrics);
  }
  void set(std::string_view phase, const Vec3& force_hp, const Vec3& torque_hp, const Vec3& torque_step,
           const Vec3& spread) {
    for (int n = 0; n < 3; ++n) {
      RunMetrics& m = metrics(kPapersAlgorithms[static_cast<std::size_t>(n)], phase);
      m.force_N.mean = 1;
      m.force_N.hp_rms = force_hp[n];
      m.torque_Nmm.mean = 5;
      m.torque_Nmm.hp_rms = torque_hp[n];
      m.torque_Nmm.step_max = torque_step[n];
      m.shaft.spread_deg = spread[n];
      m.turns = {0.5, 0.1};
      m.torque_follows_force = 0.7;
      m.contacts_mean = 15;
    }
  }
  // Returns the numbers, from 1, of the findings with this verdict.
  std::vector<std::size_t> findings_that(Verdict verdict) const {
    std::vector<std::size_t> numbers;
    const std::vector<Finding> findings = check_findings(group_, grips_);
    for (std::size_t n = 0; n < findings.size(); ++n) {
      if (findings[n].verdict == verdict) numbers.push_back(n + 1);
    }
    return numbers;
  }
  std::vector<std::size_t> disagreeing() const { return findings_that(Verdict::does_not_agree); }

  std::vector<Recording> recordings_;
  RunGroup group_;
  GripForces grips_{{0.2}, {0.13}, {0.1}};
};

using Numbers = std::vector<std::size_t>;

TEST_F(FindingsTest, AgreesWithFiguresAsInThePaper) {
  EXPECT_EQ(findings_that(Verdict::agrees), (Numbers{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST_F(FindingsTest, DoesNotRankAnAlgorithmThatLostContact) {
  RunMetrics& m = metrics("surface-points", kHolding);
  m.contact.any = m.contact.force = 0.05;
  m.contact.lost_after_s = 3.2;
  m.force_N.hp_rms = m.torque_Nmm.hp_rms = m.shaft.spread_deg = m.torque_follows_force =
      std::numeric_limits<double>::quiet_NaN();
  grips_[1] = {std::numeric_limits<double>::quiet_NaN(), 0};
  EXPECT_EQ(disagreeing(), Numbers{});
  EXPECT_EQ(findings_that(Verdict::too_little_contact), (Numbers{2, 3, 5, 7}));
  for (const Finding& f : check_findings(group_, grips_)) {
    EXPECT_EQ(f.measured.find("nan"), std::string::npos) << f.measured;
    if (f.paper_says.find("gripping") != std::string::npos) continue;
    EXPECT_EQ(f.measured.find("lost contact after 3.2 s") != std::string::npos,
              f.verdict == Verdict::too_little_contact)
        << f.measured;
  }
  EXPECT_EQ(check_findings(group_, grips_)[2].measured,
            "2 while holding, by grip 0.5, 1, 2: a force felt for long enough in 1, 0, 1 of 1 hands");
  for (GripForce& grip : grips_) grip = grips_[1];
  EXPECT_EQ(check_findings(group_, grips_)[2].measured,
            "2 felt a force in no hand while holding, whatever the grip");
  m.contact.lost_while_milling = true;
  EXPECT_NE(check_findings(group_, grips_)[1].measured.find("lost while milling, after 3.2 s"),
            std::string::npos);
}

TEST_F(FindingsTest, EachRuleFailsOnAContradictingFigure) {
  const auto fails_with = [&](double& place, double value) {
    const double before = std::exchange(place, value);
    const Numbers failing = disagreeing();
    place = before;
    return failing;
  };
  RunMetrics& one = metrics("line-proxy", kMilling);
  RunMetrics& two = metrics("surface-points", kMilling);
  RunMetrics& two_held = metrics("surface-points", kHolding);
  RunMetrics& three = metrics("point-shell", kMilling);
  RunMetrics& three_held = metrics("point-shell", kHolding);
  EXPECT_EQ(fails_with(three_held.rate_hz, 949), Numbers{1});
  EXPECT_EQ(fails_with(three_held.rate_hz, 950), Numbers{});
  EXPECT_EQ(fails_with(two.force_N.hp_rms, 0.039), Numbers{2});
  EXPECT_EQ(fails_with(two_held.force_N.hp_rms, 0.039), Numbers{2});
  EXPECT_EQ(fails_with(grips_[0].hp_rms_N, 0.12), Numbers{3}) << "most in the middle";
  EXPECT_EQ(fails_with(grips_[2].hp_rms_N, 0.19), Numbers{3});
  EXPECT_EQ(fails_with(three.torque_Nmm.step_max, 15), Numbers{4});
  EXPECT_EQ(fails_with(one.turns.at_torque_step_deg, 0.4), Numbers{4}) << "a peak without a jump";
  EXPECT_EQ(fails_with(two_held.torque_follows_force, 0.4), Numbers{5});
  EXPECT_EQ(fails_with(two.torque_Nmm.hp_rms, 0.9), Numbers{5});
  EXPECT_EQ(fails_with(three.torque_Nmm.hp_rms, 0.04), Numbers{6}) << "as calm as the force";
  EXPECT_EQ(fails_with(three_held.torque_Nmm.hp_rms, 0.5), Numbers{6}) << "not less calm while milling";
  EXPECT_EQ(fails_with(two_held.torque_Nmm.hp_rms, 1.1), Numbers{7});
  EXPECT_EQ(fails_with(two.shaft.spread_deg, 1), Numbers{8});
  EXPECT_EQ(fails_with(three.contacts_mean, 209), Numbers{9});
}

TEST_F(FindingsTest, MarksFindingsOnMissingRunsAsNotRecorded) {
  const auto gone = [](const MeasuredRun& run) { return run.algorithm == "surface-points"; };
  group_.runs.erase(std::remove_if(group_.runs.begin(), group_.runs.end(), gone), group_.runs.end());
  grips_.clear();
  // All except for the rate and the finding on 3 alone.
  EXPECT_EQ(findings_that(Verdict::not_recorded), (Numbers{2, 3, 4, 5, 7, 8}));
}

TEST(GroupRuns, RefusesAndNamesTwoRunsOfTheSameAlgorithmAndPhase) {
  std::vector<Recording> recordings{short_run("line-proxy", kMilling), short_run("line-proxy", kMilling)};
  recordings[1].path = "again.h5";
  try {
    group_runs(recordings);
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.starts_with("again.h5: is line-proxy, milling, as is line-proxy.h5")) << what;
  }
  recordings[1].description.phase = kHolding;
  EXPECT_EQ(group_runs(recordings).runs.size(), 2u);
  EXPECT_THROW(group_runs({}), InputError);
}

}  // namespace
}  // namespace osteomill
