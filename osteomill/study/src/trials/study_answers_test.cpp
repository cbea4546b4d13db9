#include "trials/study_answers.h"

#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "osteomill/study/study_findings.h"

#include "tests/support/study_samples.h"
#include "trials/findings_section.h"
#include "trials/hands_section.h"

namespace osteomill {
namespace {

using testing_support::sample_rows;

std::string conclusions_of(const std::vector<MeasuredRun>& rows) {
  std::string text;
  for (const Table& table : conclusions(Study(rows))) text += plain_text(table) + "\n";
  return text;
}

// Returns a row of a table, with its cells separated by bars.
std::string row_of(const Table& table, const std::string& name) {
  for (const auto& row : table.rows) {
    std::string text;
    for (const Cell& cell : row) text += cell.text() + "|";
    if (row[0].text() == name) return text;
  }
  return "none";
}

// Returns a row of the section's table of milling.
std::string force_row(const std::vector<MeasuredRun>& rows) {
  return row_of(hands_section(Study(rows), {}).parts.back().tables.front(), "force above 20 Hz, rms (N)");
}

// Returns a row of the table of answers.
std::string answer_row(const std::vector<MeasuredRun>& rows, const std::string& algorithm) {
  return row_of(conclusions(Study(rows))[0], algorithm);
}

void expect_says(const std::string& text, const std::string& what) {
  EXPECT_NE(text.find(what), std::string::npos) << what << "\n in:\n" << text;
}

void lose(MeasuredRun& row) {
  RunMetrics& m = row.metrics;
  m.force_N.hp_rms = m.torque_Nmm.hp_rms = m.force_N.hp_share = m.torque_Nmm.hp_share =
      std::numeric_limits<double>::quiet_NaN();
  m.contact.lost_after_s = 3.2;
}

TEST(Conclusions, RankAlgorithmsAndMarkUnsettledPairs) {
  const std::vector<MeasuredRun> rows = sample_rows(8);
  const Study study(rows);
  const std::vector<Table> tables = conclusions(study);
  EXPECT_EQ(tables[0].header.size(), 8u);
  EXPECT_EQ(tables[0].header[1], "Calm force while milling\nabove 20 Hz, of the mean\n(less is calmer)");
  // The order of 1 and 3 in force varies between hands; that of their torques does not.
  EXPECT_TRUE(
      answer_row(rows, "1 line-proxy").starts_with("1 line-proxy|5.2 %\nnot settled\nagainst 3|30 %\n3rd|"));
  EXPECT_TRUE(answer_row(rows, "2 surface-points").starts_with("2 surface-points|52 %\n3rd|20 %\n2nd|"));
  EXPECT_TRUE(answer_row(rows, "3 point-shell")
                  .starts_with("3 point-shell|5.2 %\nnot settled\nagainst 1|10 %\n1st|"));
  EXPECT_EQ(recommendation_text(study),
            "3 point-shell is calmest in torque while milling: 10 % (2 surface-points 20 %, p = 0.023, 8 "
            "hands). 3 point-shell is calmest in torque while holding: 10 % (2 surface-points 20 %, p = "
            "0.023, 8 hands). Not settled: calm force while milling (3 point-shell 5.2 %, 1 line-proxy 5.2 "
            "%, p = 0.84, 8 hands), calm force while holding (3 point-shell 5.2 %, 1 line-proxy 5.2 %, p = "
            "0.84, 8 hands) and a shaft that follows the handle while milling (1 line-proxy 0 degrees, 2 "
            "surface-points 0 degrees, p = 1, 8 hands).");
  EXPECT_EQ(tables[1].header.front(), "8 of the paper's nine findings") << "without the one on grips";
  EXPECT_TRUE(row_of(tables[1], "agrees")
                  .starts_with("agrees|5|“all the algorithms fulfill the real-time requirements”, in 8 of 8 "
                               "hands;\n"));
  EXPECT_TRUE(row_of(tables[1], "does not agree").starts_with("does not agree|3|"));
  EXPECT_TRUE(sample_size_warning(study).empty());
}

TEST(Conclusions, StateSizeOfDifferenceAndIfItIsPerceptible) {
  EXPECT_TRUE(force_row(sample_rows(8))
                  .starts_with("force above 20 Hz, rms (N)|0.104 [0.0909, 0.119]|1.04 [1.01, 1.08]|0.104 ["));
  expect_says(force_row(sample_rows(8)),
              "|2 is 10 times 1, p = 0.023\n1 and 3: not settled, p = 0.84\n2 is 10 times 3, p = 0.023|");
  std::vector<MeasuredRun> twice = sample_rows(8);
  for (MeasuredRun& r : twice)
    r.metrics.force_N.hp_rms =
        (r.algorithm == "surface-points" ? 1.996 : 1) * (0.1 + 0.001 * static_cast<double>(r.seed));
  expect_says(force_row(twice), "2 is 100 % more than 1, p = 0.023");
  // A tenth more in every hand: less than the fifth of a vibration that a hand notices.
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    const double more = r.algorithm == "surface-points" ? 1.1 : 1;
    r.metrics.force_N.hp_rms = more * (0.1 + 0.001 * static_cast<double>(r.seed));
    r.metrics.force_N.hp_share = r.metrics.force_N.hp_rms / 2;
  }
  expect_says(force_row(rows), "2 is 10 % more than 1: same for a hand, p = 0.023");
  expect_says(answer_row(rows, "2 surface-points"), "%\n1st, same for\na hand as 1, 3|");
}

TEST(Conclusions, RankTorqueByShareOfItsMean) {
  // Its torque trembles half as much, because it is a tenth.
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm != "line-proxy") continue;
    r.metrics.torque_Nmm.hp_rms = 0.5;
    r.metrics.torque_Nmm.mean = 1;
    r.metrics.torque_Nmm.hp_share = 0.5;
  }
  const std::string row = answer_row(rows, "1 line-proxy");
  const std::size_t milling = row.find("|50 %\n3rd|");
  ASSERT_NE(milling, std::string::npos) << row;
  EXPECT_NE(row.find("|50 %\n3rd|", milling + 1), std::string::npos) << "holding: " << row;
}

TEST(Conclusions, ConsiderOnlyAlgorithmsCompletedByMostHands) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows)
    if (r.algorithm == "line-proxy" && r.phase == kHolding && r.seed < 4) r.not_reached = "the shaft turned";
  expect_says(answer_row(rows, "1 line-proxy"), "|5 of 8|");
  // An algorithm that most hands could not complete the test with is not recommended.
  for (MeasuredRun& r : rows) {
    if (r.algorithm == "line-proxy") r.metrics.torque_Nmm.hp_share = 0.001;
    if (r.algorithm == "point-shell" && r.seed < 5) r.not_reached = "the shaft turned";
  }
  const std::string take = recommendation_text(Study(rows));
  EXPECT_TRUE(take.starts_with(
      "Of the algorithms that did all of the test in most hands, 1 line-proxy is calmest in force while "
      "milling: 5.2 % (2 surface-points 52 %, p = 0.023, 8 hands). 3 point-shell had less, which is not "
      "settled (5.2 %, p = 0.84, 8 hands), but did all of the test in 4 of 8 hands. "))
      << take;
  expect_says(take, "1 line-proxy is calmest in torque while milling: 0.1 % (2 surface-points 20 %, p = 0.0");
  expect_says(take, "Not considered, because too few hands did all of the test: 3 point-shell (4 of 8).");
  // It has no rank, and takes none from the others.
  expect_says(answer_row(rows, "3 point-shell"), "|10 %\nnot considered|");
  expect_says(answer_row(rows, "2 surface-points"), "|20 %\n2nd|");
  expect_says(table_explanation(Study(rows)),
              "Ranks are those among the algorithms that did all of the test");
  for (MeasuredRun& r : rows) r.not_reached = r.algorithm == "surface-points" ? "" : "lost";
  EXPECT_EQ(recommendation_text(Study(rows)),
            "Only 2 surface-points (8 of 8) did all of the test in most hands, so nothing is compared; 1 "
            "line-proxy (0 of 8) and 3 point-shell (0 of 8) did not.");
  EXPECT_TRUE(answer_row(rows, "2 surface-points").starts_with("2 surface-points|52 %|20 %|"));
  for (MeasuredRun& r : rows) r.not_reached = "lost";
  EXPECT_TRUE(
      recommendation_text(Study(rows)).starts_with("None did all of the test in most hands, so nothing "));
  for (MeasuredRun& r : rows) r.not_reached = r.algorithm == "line-proxy" && r.seed < 5 ? "lost" : "";
  expect_says(recommendation_text(Study(rows)),
              "3 point-shell is calmest in torque while milling: 10 % (2 surface-points 20 %, p = 0.023, 8 "
              "hands). 1 line-proxy was calmer (0.1 %, p = 0.023, 8 hands), but did all of the test in 4 of "
              "8 hands.");
  expect_says(answer_row(rows, "3 point-shell"), "|8 of 8|");
}

// Two more runs of the first hand, whose forces tremble by 0.01 and 0.03 N more.
TEST(Conclusions, ReportSpreadDueToTremorAlone) {
  for (const std::uint64_t seeds : {1u, 8u}) {
    std::vector<MeasuredRun> rows = sample_rows(seeds);
    for (const double more_N : {0.01, 0.03}) {
      for (const MeasuredRun& own : sample_rows(1)) {
        MeasuredRun& other = rows.emplace_back(own);
        other.metrics.force_N.hp_rms += more_N;
        other.metrics.force_N.hp_share += more_N / 2;
        other.other_tremor = more_N > 0.02 ? 2 : 1;
      }
    }
    const Study study(rows);
    EXPECT_EQ(study.rows().size(), 6 * seeds);
    if (seeds == 1) {
      expect_says(answer_row(rows, "2 surface-points"), "|50 %\n50 to 52 %|20 %\n20 to 20 %|");
      expect_says(table_explanation(study), "the range over 3 runs of this hand");
    } else {
      // The median of the differences 0.01, 0.02 and 0.03.
      expect_says(force_row(rows), "|1.04 [1.01, 1.08]\ntremor 0.02|");
      expect_says(force_row(rows), "2 is 10 times 1, p = 0.023\n");
      expect_says(html(hands_section(study, {})), "that of seed 1, with different tremors");
    }
  }
  EXPECT_EQ(force_row(sample_rows(8)).find("tremor"), std::string::npos);
}

TEST(Conclusions, MarkDifferencesSmallerThanTremorEffect) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    const double more = r.algorithm == "surface-points" ? 1.5 : 1;
    r.metrics.force_N.hp_rms = more * (0.1 + 0.001 * static_cast<double>(r.seed));
  }
  expect_says(force_row(rows), "2 is 50 % more than 1, p = 0.023");
  for (const MeasuredRun& own : sample_rows(1)) {
    MeasuredRun& other = rows.emplace_back(own);
    other.metrics.force_N.hp_rms = own.algorithm == "surface-points" ? 0.3 : 0.1;
    other.other_tremor = 1;
  }
  expect_says(force_row(rows), "2 is 50 % more than 1, less than another tremor gives, p = 0.023");
}

TEST(Conclusions, ShowProbeResultsAndDashesForUnprobedAlgorithms) {
  const std::map<std::string, Probe> probes{{"line-proxy", {2.5, 0.03}}, {"point-shell", {1, kNotMeasured}}};
  const Table table = conclusions(Study(sample_rows(1)), probes)[0];
  expect_says(row_of(table, "1 line-proxy"), "|3 %|2.5|");
  expect_says(row_of(table, "2 surface-points"), "|–|–|");
  expect_says(row_of(table, "3 point-shell"), "|no force felt|1|");
}

TEST(Conclusions, ClaimNothingWithTooFewHands) {
  const Study one{sample_rows(1)};
  EXPECT_TRUE(sample_size_warning(one).starts_with(
      "Only one hand tried this, too few to say which algorithm is better: it takes 7 or more "));
  EXPECT_EQ(conclusions(one)[0].header.front(), "In this hand");
  EXPECT_EQ(recommendation_text(one), "");
  EXPECT_EQ(plain_text(conclusions(one)[0]).find("1st"), std::string::npos);
  expect_says(plain_text(conclusions(one)[1]), "holds in this hand");
  EXPECT_EQ(plain_text(conclusions(one)[1]).find("agrees"), std::string::npos);
  EXPECT_EQ(force_row(sample_rows(6)).find(" times "), std::string::npos) << force_row(sample_rows(6));
}

TEST(Conclusions, StateNumberOfHandsIfSomeLostContact) {
  for (const std::uint64_t lost : {3u, 4u}) {
    std::vector<MeasuredRun> rows = sample_rows(8);
    for (MeasuredRun& r : rows) {
      if (r.algorithm == "line-proxy" && r.seed <= lost) lose(r);
    }
    expect_says(force_row(rows), fmt::format("] in {} of 8 hands|1.04", 8 - lost));
    expect_says(force_row(rows), fmt::format("1 and 3 in {} hands: not settled", 8 - lost));
    expect_says(answer_row(rows, "1 line-proxy"),
                lost == 4 ? "\n4 of 8 hands\nnot considered|" : "\n5 of 8 hands\nnot settled\nagainst 2, 3|");
    // Half of the hands are not a majority, and do not affect the ranks of the others.
    if (lost == 4) expect_says(answer_row(rows, "3 point-shell"), "|10 %\n1st|");
    const Table verdicts = conclusions(Study(rows))[1];
    EXPECT_EQ(row_of(verdicts, "not recorded"), "none");
    EXPECT_TRUE(
        row_of(verdicts, "too little contact").starts_with(lost == 4 ? "too little contact|2|" : "none"));
  }
}

TEST(Conclusions, SkipFiguresThatMostHandsCouldNotMeasure) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows)
    if (r.phase == kMilling && r.algorithm != "point-shell") r.metrics.torque_Nmm.hp_share = kNotMeasured;
  const std::string take = recommendation_text(Study(rows));
  expect_says(take, "3 point-shell is calmest in torque while holding: 10 % (2 surface-points 20 %, p = ");
  expect_says(take, "Not compared, because most hands felt too little of it: calm torque while milling.");
}

TEST(Conclusions, ReportInsignificantDifferencesAsNotSettled) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  std::erase_if(rows, [](const MeasuredRun& r) { return r.algorithm == "surface-points"; });
  for (MeasuredRun& r : rows) {
    r.metrics.force_N.hp_rms = r.seed % 2 == (r.algorithm == "line-proxy" ? 0u : 1u) ? 0.1 : 0.2;
  }
  expect_says(force_row(rows), "|1 and 3: not settled, p = ");
}

TEST(Conclusions, ListUnreachedGoalsWithTheirHandCounts) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm == "surface-points" && r.phase == kHolding && r.seed < 4)
      r.not_reached = r.seed == 1 ? "the tool was lost; the burr moved" : "the tool was lost";
  }
  const Study study(rows);
  expect_says(html(hands_section(study, {})),
              "the burr moved (1 of 8 hands); the tool was lost (3 of 8 hands)</span></td>");
  expect_says(check_study_findings(study)[1].of_medians.measured,
              "(not all reached: 2 surface-points, holding)");
}

TEST(Conclusions, NameAndExcludeAlgorithmsThatLostContact) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm == "point-shell") lose(r);
  }
  expect_says(force_row(rows), "|lost contact after 3.2 s in 8 of 8 hands|2 is 10 times 1, p = 0.0078|");
  const std::string text = conclusions_of(rows);
  expect_says(text, "too little contact  ");
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

TEST(Conclusions, ListReasonsForMissingForceWithHandCounts) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  for (MeasuredRun& r : rows) {
    if (r.algorithm != "surface-points") continue;
    if (r.seed < 4) {
      lose(r);
    } else {
      r.metrics.force_N.hp_rms = r.metrics.force_N.hp_share = kNotMeasured;
      r.metrics.contact.force = 0;
    }
  }
  expect_says(force_row(rows),
              "|felt a force for less than 1 % of the time in 5 of 8 hands; lost contact after 3.2 s in 3 of "
              "8 hands|");
  const StudyFinding calmer = check_study_findings(Study(rows))[1];
  expect_says(calmer.of_medians.measured,
              "2: felt a force for less than 1 % of the time in 5 of 8 hands; lost");
  EXPECT_EQ(calmer.tested, 0u);
  const std::string section = html(findings_section(Study(rows)));
  expect_says(section, "<td>not tested</td><td>–</td>");
  EXPECT_EQ(section.find("0 of 0"), std::string::npos);
}

TEST(Conclusions, CompareNothingIfThereIsOnlyOneAlgorithm) {
  std::vector<MeasuredRun> rows = sample_rows(8);
  std::erase_if(rows, [](const MeasuredRun& r) { return r.algorithm != "line-proxy"; });
  const Study study(rows);
  EXPECT_EQ(conclusions(study)[0].rows.size(), 1u);
  EXPECT_EQ(plain_text(conclusions(study)[0]).find("settled"), std::string::npos);
  EXPECT_EQ(recommendation_text(study), "");
  EXPECT_EQ(sample_size_warning(Study(std::vector<MeasuredRun>{rows[0], rows[1]})), "");
  EXPECT_EQ(comparison_sentence(study, "a tooth").find("1 line-proxy milled a bone (a tooth) in 8 "), 0u);
}

}  // namespace
}  // namespace osteomill
