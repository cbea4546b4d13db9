#include "trials/conclusions.h"

#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "osteomill/study/study_findings.h"

#include "tests/support/study_samples.h"
#include "trials/study_section.h"

namespace osteomill {
namespace {

using testing_support::sample_rows;

std::string conclusions_of(const std::vector<MeasuredRun>& rows) {
  std::string text;
  for (const std::string& sentence : conclusions(Study(rows))) text += sentence + "\n";
  return text;
}

void expect_says(const std::string& text, const std::string& what) {
  EXPECT_NE(text.find(what), std::string::npos) << what << "\n in:\n" << text;
}

void lose(MeasuredRun& row) {
  RunMetrics& m = row.metrics;
  m.force_N.hp_rms = m.torque_Nmm.hp_rms = std::numeric_limits<double>::quiet_NaN();
  m.contact.lost_after_s = 3.2;
}

TEST(Conclusions, IsFiveSentencesWithTheirNumbers) {
  const std::string text = conclusions_of(sample_rows(8));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
  expect_says(text,
              "Force above 20 Hz, rms, while milling, median of the hands: 0.104 N (1 line-proxy), "
              "1.04 N (2 surface-points) and 0.104 N (3 point-shell); least with");
  expect_says(text, "least with 3 point-shell, significantly against 1 and 2");
  expect_says(text, "findings on force, torque and shaft, 4 agree in 8 hands, 3 do not (");
  EXPECT_TRUE(too_few_hands(Study(sample_rows(8))).empty());
}

TEST(Conclusions, WithTooFewHandsNothingIsClaimed) {
  const Study one{sample_rows(1)};
  EXPECT_TRUE(too_few_hands(one).starts_with(
      "Only one hand tried this, too few to say which algorithm is the better: a difference shows in 7 "));
  const std::string text = conclusions_of(sample_rows(6));
  for (const char* claim : {"least", "significant"}) {
    EXPECT_EQ(text.find(claim), std::string::npos) << claim << " in " << text;
  }
  for (const char* claim : {"better", "worse"}) EXPECT_EQ(text.find(claim), std::string::npos) << text;
}

TEST(Conclusions, WhereSomeHandsLostContactTheMedianSaysOfHowMany) {
  for (const std::uint64_t lost : {3u, 4u}) {
    std::vector<MeasuredRun> rows = sample_rows(8);
    for (MeasuredRun& r : rows) {
      if (r.algorithm == "line-proxy" && r.seed <= lost) lose(r);
    }
    const std::string text = conclusions_of(rows);
    expect_says(text, fmt::format("(1 line-proxy, in {} of 8 hands)", 8 - lost));
    // Half of the hands do not speak for all; and no other grips were tried.
    expect_says(text, lost == 4 ? ", 3 could not be tested" : ", 1 could not be tested");
  }
}

TEST(Conclusions, WhereNothingIsSignificantNobodyIsLeast) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  std::erase_if(rows, [](const MeasuredRun& r) { return r.algorithm == "surface-points"; });
  for (MeasuredRun& r : rows) {
    r.metrics.force_N.hp_rms = r.seed % 2 == (r.algorithm == "line-proxy" ? 0u : 1u) ? 0.1 : 0.2;
  }
  expect_says(conclusions_of(rows), "; no difference between the least and another is significant");
}

TEST(Conclusions, WhoseShaftDidNotLeanIsNamed) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    r.metrics.contact.shaft = r.algorithm == "line-proxy" && r.seed < 4 ? 0.2 : 1;
  }
  const std::string text = what_was_compared(Study(rows), "ball");
  expect_says(text, "less than half of that time with 1 line-proxy (3 of 8 hands).");
  for (MeasuredRun& r : rows) r.metrics.contact.shaft = 1;
  EXPECT_EQ(what_was_compared(Study(rows), "ball").find("less than half"), std::string::npos);
}

TEST(Conclusions, WhatWasNotReachedIsSaidWithTheHandsInWhichItWasNot) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm == "surface-points" && r.phase == kHolding && r.seed < 4)
      r.not_reached = "the tool was lost";
  }
  const Study study(rows);
  expect_says(what_was_compared(study, "ball"),
              "Not all of that was reached with 2 surface-points: the tables say what.");
  expect_says(html(study_section(study, {})), "the tool was lost (3 of 8 hands)</span></td>");
  expect_says(check_study_findings(study)[1].of_medians.measured,
              "(not all reached: 2 surface-points, holding)");
}

TEST(Conclusions, WhoLostContactIsNamedAndNeverTheLeast) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm == "point-shell") lose(r);
  }
  const std::string text = conclusions_of(rows);
  expect_says(text,
              "lost contact after 3.2 s (3 point-shell); least with 1 line-proxy, significantly against 2");
  expect_says(text, "could not be tested");
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

TEST(Conclusions, OneAlgorithmHasNothingToBeComparedWith) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  std::erase_if(rows, [](const MeasuredRun& r) { return r.algorithm != "line-proxy"; });
  const std::string text = conclusions_of(rows);
  EXPECT_EQ(text.find("least"), std::string::npos) << text;
  expect_says(text, "Bone removed, while milling, median of the hands: 0 mm³ (1 line-proxy).");
}

}  // namespace
}  // namespace osteomill
