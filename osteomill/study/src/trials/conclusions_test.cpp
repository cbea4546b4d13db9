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
  for (const Table& table : conclusions(Study(rows))) text += plain_text(table) + "\n";
  return text;
}

// A row of a table, whose cells stand between bars.
std::string row_of(const Table& table, const std::string& name) {
  for (const auto& row : table.rows) {
    std::string text;
    for (const Cell& cell : row) text += cell.text() + "|";
    if (row[0].text() == name) return text;
  }
  return "none";
}

std::string force_row(const std::vector<MeasuredRun>& rows) {
  return row_of(conclusions(Study(rows))[0], "force above 20 Hz, rms, milling (N)");
}

void expect_says(const std::string& text, const std::string& what) {
  EXPECT_NE(text.find(what), std::string::npos) << what << "\n in:\n" << text;
}

void lose(MeasuredRun& row) {
  RunMetrics& m = row.metrics;
  m.force_N.hp_rms = m.torque_Nmm.hp_rms = std::numeric_limits<double>::quiet_NaN();
  m.contact.lost_after_s = 3.2;
}

TEST(Conclusions, AreWhatWasComparedWithItsFiguresAndWhatOfThePaperHolds) {
  const Study study(sample_rows(8));
  const std::vector<Table> tables = conclusions(study);
  EXPECT_EQ(tables[0].header, (std::vector<std::string>{"Median over the hands [interval]", "1 line-proxy",
                                                        "2 surface-points", "3 point-shell", "Differences"}));
  EXPECT_TRUE(force_row(sample_rows(8))
                  .starts_with(
                      "force above 20 Hz, rms, milling (N)|0.104 [0.0909, 0.119]|1.04 [1.01, 1.08]|0.104 ["));
  expect_says(force_row(sample_rows(8)), "|2 > 1, p = 0.023\n1, 3: p = 0.84\n2 > 3, p = 0.023|");
  EXPECT_EQ(tables[0].rows.size(), 4u);
  EXPECT_EQ(tables[1].header.front(), "The paper's 8 findings on force, torque and shaft");
  EXPECT_EQ(row_of(tables[1], "agrees"), "agrees|4||");
  EXPECT_TRUE(row_of(tables[1], "does not agree").starts_with("does not agree|3|"));
  EXPECT_TRUE(too_few_hands(study).empty());
}

TEST(Conclusions, WithTooFewHandsNothingIsClaimed) {
  const Study one{sample_rows(1)};
  EXPECT_TRUE(too_few_hands(one).starts_with(
      "Only 1 hand tried this, too few to say which algorithm is the better: a difference shows in 7 "));
  EXPECT_EQ(conclusions(one)[0].header,
            (std::vector<std::string>{"In this hand", "1 line-proxy", "2 surface-points", "3 point-shell"}));
  EXPECT_EQ(force_row(sample_rows(6)).find('>'), std::string::npos) << force_row(sample_rows(6));
}

TEST(Conclusions, WhereSomeHandsLostContactTheMedianSaysOfHowMany) {
  for (const std::uint64_t lost : {3u, 4u}) {
    std::vector<MeasuredRun> rows = sample_rows(8);
    for (MeasuredRun& r : rows) {
      if (r.algorithm == "line-proxy" && r.seed <= lost) lose(r);
    }
    expect_says(force_row(rows), fmt::format("] in {} of 8 hands|1.04", 8 - lost));
    // Half of the hands do not speak for all; and no other grips were tried.
    const Table verdicts = conclusions(Study(rows))[1];
    EXPECT_TRUE(row_of(verdicts, "not recorded").starts_with("not recorded|1|"));
    EXPECT_TRUE(row_of(verdicts, "lost contact").starts_with(lost == 4 ? "lost contact|2|" : "none"));
  }
}

TEST(Conclusions, WhereNothingIsSignificantNobodyIsGreater) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  std::erase_if(rows, [](const MeasuredRun& r) { return r.algorithm == "surface-points"; });
  for (MeasuredRun& r : rows) {
    r.metrics.force_N.hp_rms = r.seed % 2 == (r.algorithm == "line-proxy" ? 0u : 1u) ? 0.1 : 0.2;
  }
  expect_says(force_row(rows), "|1, 3: p = ");
}

TEST(Conclusions, WhoseShaftDidNotLeanIsNamed) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    r.metrics.contact.shaft = r.algorithm == "line-proxy" && r.seed < 4 ? 0.2 : 1;
  }
  const std::string leans = "shaft against the wall for less than half of the holding";
  EXPECT_EQ(row_of(conclusions(Study(rows))[0], leans), leans + "|3 of 8 hands|||");
  for (MeasuredRun& r : rows) r.metrics.contact.shaft = 1;
  EXPECT_EQ(row_of(conclusions(Study(rows))[0], leans), "none");
}

TEST(Conclusions, WhatWasNotReachedIsSaidWithTheHandsInWhichItWasNot) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm == "surface-points" && r.phase == kHolding && r.seed < 4)
      r.not_reached = "the tool was lost";
  }
  const Study study(rows);
  EXPECT_EQ(row_of(conclusions(study)[0], "not reached"), "not reached||the tool was lost (3 of 8 hands)||");
  expect_says(html(study_section(study, {})), "the tool was lost (3 of 8 hands)</span></td>");
  expect_says(check_study_findings(study)[1].of_medians.measured,
              "(not all reached: 2 surface-points, holding)");
}

TEST(Conclusions, WhoLostContactIsNamedAndNeverCompared) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm == "point-shell") lose(r);
  }
  expect_says(force_row(rows), "|lost contact after 3.2 s|2 > 1, p = 0.0078|");
  const std::string text = conclusions_of(rows);
  expect_says(text, "lost contact  ");
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

TEST(Conclusions, OneAlgorithmHasNothingToBeComparedWith) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  std::erase_if(rows, [](const MeasuredRun& r) { return r.algorithm != "line-proxy"; });
  const Table table = conclusions(Study(rows))[0];
  EXPECT_EQ(table.header.size(), 2u);
  EXPECT_EQ(row_of(table, "bone removed, milling (mm³)"), "bone removed, milling (mm³)|0 [0, 0]|");
}

}  // namespace
}  // namespace osteomill
