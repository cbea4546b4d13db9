#include "trials/passivity_section.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/comparison_report.h"
#include "osteomill/study/paper.h"

#include "tests/support/report_samples.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using Kind = StiffnessLimit::Kind;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// 1 follows the rule, 2 feels half of it and has no limit on the last device, 3 is always passive. Not
// measured.
std::vector<PassivityRow> sample_rows() {
  std::vector<PassivityRow> rows;
  std::vector<AlgorithmDescription> algorithms;
  for (const std::string_view name : kPapersAlgorithms) algorithms.push_back(algorithm_named(name));
  for (const TrialSettings& setup : passivity_cases(algorithms)) {
    const double damping = setup.device_damping_Ns_per_mm;
    const double delay_s = setup.hand_and_device.handle.force_delay_s;
    const double rule = passive_stiffness_rule_N_per_mm(damping, 1e-3, delay_s);
    PassivityRow row{setup.algorithm.id, damping, delay_s, {Kind::found, rule, rule}, rule};
    if (row.algorithm == "surface-points") row.limit = {Kind::found, 4 * rule, 0.5 * rule};
    if (row.algorithm == "surface-points" && damping == 0.01) row.limit = {};
    if (row.algorithm == "point-shell") row.limit = {Kind::above_all, 200, 9};
    rows.push_back(row);
  }
  return rows;
}

class PassivitySectionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    out_ = fs::path(::testing::TempDir()) / (std::string("osteomill_stability_") +
                                             ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(out_);
    fs::create_directories(out_);
  }
  // Set OSTEOMILL_KEEP_REPORTS to inspect the reports that the tests write.
  void TearDown() override {
    if (std::getenv("OSTEOMILL_KEEP_REPORTS") == nullptr) fs::remove_all(out_);
  }
  fs::path out_;
};

TEST_F(PassivitySectionTest, TableDoesNotDependOnTheOrderOfMeasurement) {
  auto rows = sample_rows();
  const Figure figure = draw_passivity_figure(rows, out_);
  const std::string page = html(passivity_section(rows, figure));
  std::stable_sort(rows.begin(), rows.end(), [](const PassivityRow& a, const PassivityRow& b) {
    return a.algorithm.label > b.algorithm.label;
  });
  const std::string reversed = html(passivity_section(rows, figure));
  const auto first_row = [](const std::string& text) {
    const std::size_t begin = text.find("N s/m", text.find("<table"));
    return text.substr(begin, text.find("</tr>", begin) - begin);
  };
  EXPECT_NE(reversed.find(first_row(page)), std::string::npos) << first_row(page) << " not in " << reversed;
}

TEST_F(PassivitySectionTest, CsvHasOneRowPerAlgorithmAndDevice) {
  const auto rows = sample_rows();
  write_passivity_csv(out_ / "stability.csv", rows);
  const std::string csv = bytes_of(out_ / "stability.csv");
  EXPECT_TRUE(
      csv.starts_with("algorithm,device_damping_Ns_per_m,device_delay_s,limit,stiffness_N_per_mm,felt_N_"
                      "per_mm,rule_N_per_mm\n"
                      "line-proxy,1,0.0003,found,1.25"))
      << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 37);
  EXPECT_NE(csv.find("surface-points,10,0.002,none,0,0,4\n"), std::string::npos) << csv;
  EXPECT_NE(csv.find("point-shell,10,0.002,above,200,9,4\n"), std::string::npos) << csv;
}

TEST_F(PassivitySectionTest, TextGivesTheRangeRelativeToTheRule) {
  const auto rows = sample_rows();
  const std::string page = html(passivity_section(rows, draw_passivity_figure(rows, out_)));
  EXPECT_NE(
      page.find("1 line-proxy 1.00 to 1.00; 2 surface-points 0.50 to 0.50, and passive at no stiffness on 3 "
                "of 12 devices; 3 point-shell passive at every stiffness on 12 of 12 devices."),
      std::string::npos);
  EXPECT_NE(page.find("none passive"), std::string::npos);
  EXPECT_NE(page.find("over 200 → 9"), std::string::npos);
  EXPECT_TRUE(bytes_of(out_ / "stability.svg").ends_with("</svg>\n\n"));
}

TEST_F(PassivitySectionTest, DescribesASingleAlgorithmThatIsNeverPassive) {
  std::vector<PassivityRow> rows = sample_rows();
  std::erase_if(rows, [](const PassivityRow& row) { return row.algorithm != "line-proxy"; });
  for (PassivityRow& row : rows) row.limit = {};
  const std::string page = html(passivity_section(rows, draw_passivity_figure(rows, out_)));
  EXPECT_NE(page.find("1 line-proxy passive at no stiffness on 12 of 12 devices."), std::string::npos);
}

TEST_F(PassivitySectionTest, StudyReportHasItsFilesAndSectionsInOrder) {
  ReportExtras extras{.passivity = sample_rows()};
  auto runs = testing_support::sample_runs(500);
  for (Recording& run : runs) run.path = out_ / run.path;
  // Hands in addition to the recorded one.
  const std::uint64_t first = runs.front().description.seed;
  for (std::uint64_t seed = first + 1; seed < first + 8; ++seed) {
    for (const Recording& run : runs) {
      const RunDescription& d = run.description;
      MeasuredRun row{.algorithm = d.algorithm, .phase = d.phase, .metrics = run_metrics(run), .seed = seed};
      row.hand_stiffness_N_per_m = 1000 * random_hand(seed).stiffness_N_per_mm;
      for (double* unrest : {&row.metrics.force_N.hp_rms, &row.metrics.force_N.hp_share})
        *unrest *= 1 + 0.01 * static_cast<double>(seed);
      extras.others.push_back(row);
      if (row.phase == kHolding) extras.in_one_hole.push_back(row);
    }
  }
  const std::string html = bytes_of(write_comparison_report(runs, out_, extras));
  for (const char* file :
       {"study.csv", "one-hole.csv", "stability.csv", "summary.csv", "figures/study_milling.svg",
        "figures/study_holding.png", "figures/stability.svg"}) {
    EXPECT_TRUE(fs::exists(out_ / file)) << file;
  }
  std::size_t place = 0;
  for (const char* next :
       {"8 simulated hands", "Calm force while milling", "The bone before and after", ">Force<", ">Torque<",
        ">Shaft<", "The paper's findings", "Study over 8 hands", "Holding still in one hole",
        "Passivity against a flat wall", "How long the ticks took", "What was run", ">Settings<"}) {
    const std::size_t found = html.find(next, place);
    ASSERT_NE(found, std::string::npos) << next;
    place = found;
  }
  for (const char* link : {"http", "<script", "url("})
    EXPECT_EQ(testing_support::without_namespaces(html).find(link), std::string::npos) << link;
  EXPECT_EQ(bytes_of(write_comparison_report(runs, out_ / "again")), html)
      << "a report of the recordings finds the tables beside them";
  for (const char* file : {"study.csv", "one-hole.csv", "stability.csv"})
    EXPECT_EQ(bytes_of(out_ / "again" / file), bytes_of(out_ / file)) << file;
  for (Recording& run : runs) run.records.back().wrench.force_N *= 2;
  const std::string other = bytes_of(write_comparison_report(runs, out_ / "other"));
  EXPECT_NE(other.find("The study.csv beside the recordings does not have their figures"), std::string::npos);
  EXPECT_FALSE(fs::exists(out_ / "other/study.csv"));
}

}  // namespace
}  // namespace osteomill
