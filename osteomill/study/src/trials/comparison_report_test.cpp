#include "osteomill/study/comparison_report.h"

#include <fstream>
#include <iterator>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/trial_plan.h"
#include "osteomill/study/write_rates_report.h"
#include "osteomill/study/write_report.h"

#include "tests/support/report_samples.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

/// Returns rates at the paper's resolutions, with the paper's own; the measured ones are made up.
std::vector<RateRow> sample_rates() {
  const auto row = [](std::string_view algorithm, const char* resolution, int points, double us,
                      double paper_hz) {
    return RateRow{algorithm_named(algorithm).id, resolution, points,   us, 1.7 * us,
                   std::min(1000.0, 1e6 / us),    1e6 / us,   paper_hz, 999};
  };
  return {
      row("line-proxy", "50 vertices", 51, 2.1, 984),    row("line-proxy", "100 vertices", 101, 4, 964),
      row("line-proxy", "250 vertices", 251, 9, 884),    row("line-proxy", "500 vertices", 501, 18, 795),
      row("line-proxy", "1000 vertices", 1001, 36, 544), row("surface-points", "10 slices", 104, 3, 974),
      row("surface-points", "20 slices", 184, 5, 951),   row("surface-points", "30 slices", 264, 8, 922),
      row("surface-points", "50 slices", 424, 13, 837),  row("surface-points", "100 slices", 824, 25, 622),
      row("point-shell", "scale 1", 73800, 24, 127),     row("point-shell", "scale 2", 18549, 9, 507),
      row("point-shell", "scale 3", 8399, 5, 987),       row("point-shell", "scale 4", 4700, 3.2, 0)};
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> operands_of(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

class ReportTest : public ::testing::Test {
 protected:
  void SetUp() override {
    out_ = fs::path(::testing::TempDir()) / (std::string("osteomill_report_") +
                                             ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(out_);
  }
  // Set OSTEOMILL_KEEP_REPORTS to inspect the reports that the tests write.
  void TearDown() override {
    if (std::getenv("OSTEOMILL_KEEP_REPORTS") == nullptr) fs::remove_all(out_);
  }

  void expect_refused(const std::vector<Recording>& runs, const std::string& reason) {
    try {
      write_comparison_report(runs, out_);
      ADD_FAILURE() << reason;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
    EXPECT_FALSE(fs::exists(out_ / "report.html"));
  }

  fs::path out_;
};

TEST_F(ReportTest, WritesAComparisonAsOneSelfContainedPage) {
  const fs::path page = write_comparison_report(sample_runs(), out_);
  EXPECT_EQ(page, out_ / "report.html");
  EXPECT_EQ(operands_of(out_), (std::vector<std::string>{"figures", "report.html", "summary.csv"}));
  std::vector<std::string> expected;
  for (const char* name :
       {"bone", "fig6_rate", "fig7_force", "fig8_torque", "fig9_shaft", "path", "removed"}) {
    expected.push_back(std::string(name) + ".png");
    expected.push_back(std::string(name) + ".svg");
    EXPECT_LT(fs::file_size(out_ / "figures" / expected.back()), 1500000u) << name;
    EXPECT_TRUE(bytes_of(out_ / "figures" / expected.back()).ends_with("</svg>\n\n")) << name;
  }
  EXPECT_EQ(operands_of(out_ / "figures"), expected);
  const std::string html = bytes_of(page);
  EXPECT_TRUE(html.ends_with("</html>\n"));
  for (const char* link : {"http", "<script", "<link", "url(", "src=\"f"}) {
    EXPECT_EQ(testing_support::without_namespaces(html).find(link), std::string::npos) << link;
  }
  EXPECT_NE(html.find("osteomill compare --out &lt;folder&gt; --seed 1"), std::string::npos);
  EXPECT_NE(html.find("bone is felt when it meets the burr's centre, 1.5 mm after it met the "
                      "burr's surface"),
            std::string::npos);
  EXPECT_NE(html.find("holds in this hand</span>"), std::string::npos);
  const std::string summary = bytes_of(out_ / "summary.csv");
  EXPECT_EQ(std::count(summary.begin(), summary.end(), '\n'), 7);
  EXPECT_NE(summary.find("\npoint-shell,holding,20000,"), std::string::npos);
}

// Runs of different length remove different volumes at the same rate.
TEST_F(ReportTest, ShowsRemovalRatesBesideVolumes) {
  std::vector<Recording> runs = sample_runs(4000);
  runs.front().records.resize(3000);
  for (Recording& run : runs)
    for (TickRecord& r : run.records) {
      r.spindle_on = run.description.phase == kMilling;
      r.dt_s = 1e-3;
      r.burr_force_W_N.z() = -1;
      if (r.spindle_on) r.removed_mm3 = 2 * r.time_s;
    }
  const std::string html = bytes_of(write_comparison_report(runs, out_));
  const std::size_t volumes = html.find("<th>bone removed (mm³)</th>");
  const std::size_t rates = html.find("<th>bone removed per second of cutting (mm³/s)</th>");
  ASSERT_NE(volumes, std::string::npos);
  ASSERT_NE(rates, std::string::npos);
  const auto row_at = [&](std::size_t at) { return html.substr(at, html.find("</tr>", at) - at); };
  EXPECT_NE(row_at(volumes).find("5.998"), std::string::npos) << row_at(volumes);
  EXPECT_NE(row_at(volumes).find("7.998"), std::string::npos) << row_at(volumes);
  EXPECT_EQ(row_at(rates).find("5."), std::string::npos) << row_at(rates);
  EXPECT_NE(row_at(rates).find("1.999"), std::string::npos) << row_at(rates);
  EXPECT_NE(html.find("The milling took 3 to 4 s."), std::string::npos);
}

TEST_F(ReportTest, ReportsWhyAnAlgorithmWasNotMatched) {
  std::vector<Recording> runs = sample_runs(200);
  for (Recording& run : runs) {
    run.description.settings.push_back({std::string(kMatchedStiffnessKey), 1.5, "N/mm"});
    run.description.settings.push_back({std::string(kNotMatchedKey), std::string("another leaps"), ""});
  }
  const std::string html = bytes_of(write_comparison_report(runs, out_));
  EXPECT_NE(html.find("a flat wall is felt as 1.5 N/mm"), std::string::npos);
  EXPECT_NE(html.find("are not matched. Left out of this comparison: another leaps.</p>"), std::string::npos);
}

// A report of a session in the window describes what the person did, and does not mention trials.
TEST_F(ReportTest, DescribesASessionWithoutMentioningTrials) {
  Recording run = sample_run("point-shell", "milling");
  run.description.phase = "";
  for (TickRecord& record : run.records) record.spindle_on = record.time_s < 5, record.dt_s = 0.001;
  const std::string html = bytes_of(write_report({run}, out_));
  EXPECT_NE(html.find("<p>3 point-shell: 20.0 s, of which the spindle ran for 5.0 s. The burr went "),
            std::string::npos);
  EXPECT_NE(html.find("mm³ of bone were removed. The tool touched for "), std::string::npos);
  for (const char* of_a_trial : {"simulated hand", "paper", "hand tried", "too few to say", "Milling<br>"}) {
    EXPECT_EQ(html.find(of_a_trial), std::string::npos) << of_a_trial;
  }
  EXPECT_LT(html.find("The bone before and after"), html.find(">Force<"));
}

TEST_F(ReportTest, ReportsAnUndoneCutAsRestoredBone) {
  Recording run = sample_run("point-shell", "milling");
  run.description.phase = "";
  run.records.back().removed_mm3 = run.records.front().removed_mm3;
  const double most_mm3 = run.records[run.records.size() - 2].removed_mm3;
  ASSERT_GT(most_mm3, 1);
  const std::string html = bytes_of(write_report({run}, out_));
  EXPECT_NE(
      html.find(fmt::format("and {0:.1f} mm³ of bone were removed; {0:.1f} mm³ were restored.", most_mm3)),
      std::string::npos);
}

TEST_F(ReportTest, AcceptsASingleRecording) {
  Recording run = sample_run("surface-points", kHolding, 500);
  const std::string html = bytes_of(write_comparison_report({run}, out_));
  EXPECT_NE(html.find("8 further findings belong to algorithms, phases or grips that were not tried here"),
            std::string::npos);
  EXPECT_EQ(html.find("compared"), std::string::npos);
  EXPECT_TRUE(fs::exists(out_ / "figures/fig9_shaft.svg"));
  EXPECT_FALSE(fs::exists(out_ / "figures/bone.svg"));
}

TEST_F(ReportTest, WritesAReportOfAToolThatNeverMovesOrTouches) {
  Recording run;
  run.description.algorithm = algorithm_named("line-proxy").id;
  for (int n = 0; n < 100; ++n) {
    TickRecord r;
    r.time_s = 0.001 * n;
    run.records.push_back(r);
  }
  write_comparison_report({run}, out_);
  EXPECT_TRUE(fs::exists(out_ / "report.html"));
}

TEST_F(ReportTest, NotesIncompleteAndDifferingRecordings) {
  std::vector<Recording> runs;
  for (const std::string& algorithm : algorithm_names()) {
    runs.push_back(sample_run(algorithm, kHolding, 200));
  }
  runs[0].complete = false;
  runs[1].dropped = 7;
  runs[2].description.scan_name = "<script>another</script>";
  const std::string html = bytes_of(write_comparison_report(runs, out_));
  EXPECT_NE(html.find("line-proxy-holding.h5 is unfinished"), std::string::npos);
  EXPECT_NE(html.find("surface-points-holding.h5 lacks 7 ticks"), std::string::npos);
  EXPECT_NE(html.find("These recordings differ in scan_name."), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;another"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
}

// The burr of the samples moves down from z = 20 mm at 0.2 mm/s.
TEST_F(ReportTest, ReportsPushAndDepthAndABurrThatWentTooDeep) {
  for (const double entry_z_mm : {20.0, 21.0}) {
    std::vector<Recording> runs = sample_runs();
    for (Recording& run : runs) {
      std::vector<RunSetting>& settings = run.description.settings;
      settings.push_back({"hand.push", 4.0, "N"});
      settings.push_back({std::string(kScriptEntryKey), fmt::format("12,12,{}", entry_z_mm), "mm"});
      settings.push_back({std::string(kScriptDirectionKey), std::string("0,0,-1"), ""});
    }
    const std::string html = bytes_of(write_comparison_report(runs, out_));
    EXPECT_NE(
        html.find("The hand pushes with at most 4 N; it aims for 90 % of that while it feeds the burr in, "
                  "60 % while it leans the shaft and 50 % while it holds. The greatest force that the "
                  "recorded hand felt was 1.8 N with 1 line-proxy"),
        std::string::npos);
    const bool is_deep = entry_z_mm > 20;
    EXPECT_NE(
        html.find(is_deep ? "below the entry by 6.5 mm with 1 line-proxy" : "by 5.5 mm with 1 line-proxy"),
        std::string::npos);
    EXPECT_EQ(html.find("the burr went deeper than the 3 mm that were planned: 6.5 mm with 1 line-proxy, ") !=
                  std::string::npos,
              is_deep);
    EXPECT_NE(
        html.find("Forces, torques and shaft directions without contact are not counted in the tables."),
        std::string::npos);
  }
}

// Two comparisons with different burr, push and seed, and the remains of a third.
TEST_F(ReportTest, DrawsNoConclusionFromDifferingRecordings) {
  std::vector<Recording> runs = sample_runs(200);
  const std::string together = bytes_of(write_comparison_report(runs, out_));
  EXPECT_NE(together.find("milled the same bone"), std::string::npos);
  EXPECT_EQ(together.find("These recordings differ"), std::string::npos);
  RunDescription& other = runs[2].description;
  other.seed = 7;
  other.tool.burr_radius_mm = 2.25;
  for (RunSetting& setting : other.settings)
    if (setting.key == "push") setting.value = 3.5;
  const std::string mix = bytes_of(write_comparison_report(runs, out_));
  EXPECT_NE(mix.find("These recordings differ in burr_radius_mm, seed, push (N)."), std::string::npos);
  EXPECT_NE(mix.find("<td>2.25</td><td>7</td><td>3.5</td>"), std::string::npos);
  for (const char* untrue : {"the same bone", "one simulated hand", "agrees</span>", "Tool: a burr of"})
    EXPECT_EQ(mix.find(untrue), std::string::npos) << untrue;
}

TEST_F(ReportTest, DrawsNoConclusionIfAnAlgorithmLacksAPhase) {
  std::vector<Recording> runs = sample_runs(200);
  runs.pop_back();
  const std::string html = bytes_of(write_comparison_report(runs, out_));
  EXPECT_NE(html.find("an algorithm lacks a phase that another was recorded with"), std::string::npos);
  EXPECT_EQ(html.find("the same bone"), std::string::npos);
}

TEST_F(ReportTest, NotesMissingPicturesInTheirPlace) {
  std::vector<Recording> runs{sample_run("line-proxy", kMilling, 100)};
  const std::string_view told = "No pictures of the bone: OpenGL was not available";
  EXPECT_EQ(bytes_of(write_comparison_report(runs, out_)).find(told), std::string::npos);
  runs[0].pictures.clear();
  runs[0].description.settings.push_back({std::string(kPicturesKey), "none, as OpenGL could not be had", ""});
  const std::string html = bytes_of(write_comparison_report(runs, out_));
  EXPECT_GT(html.find(told), html.find("The bone before and after"));
  EXPECT_LT(html.find(told), html.find("<figure>"));
}

TEST_F(ReportTest, RefusesAndNamesADamagedPicture) {
  std::vector<Recording> runs{sample_run("line-proxy", kMilling, 100)};
  runs[0].pictures[0].png = {1, 2, 3};
  expect_refused(runs, "line-proxy-milling.h5: the picture 'after' is not a complete PNG");
  runs[0].pictures[0].png = sample_png(true);
  runs[0].pictures[0].png.resize(200);
  expect_refused(runs, "is not a complete PNG");
}

TEST_F(ReportTest, NamesAFolderThatCannotBeCreated) {
  std::ofstream(out_) << "a file";
  expect_refused(sample_runs(100), out_.string());
}

TEST_F(ReportTest, ShowsRatesBesideThoseOfThePaper) {
  MeasuredRates measured{sample_rates(), {}};
  measured.rows.front().paced_rate_hz = 940;
  const fs::path page = write_rates_report(measured, out_);
  EXPECT_EQ(page, out_ / "rates.html");
  EXPECT_EQ(operands_of(out_), (std::vector<std::string>{"figures", "rates.csv", "rates.html"}));
  EXPECT_EQ(operands_of(out_ / "figures"), (std::vector<std::string>{"rates.png", "rates.svg"}));
  const std::string csv = bytes_of(out_ / "rates.csv");
  EXPECT_TRUE(csv.starts_with(
      "algorithm,resolution,points,step_us_median,step_us_p99,rate_hz,steps_per_s,paper_rate_hz,"
      "paced_rate_hz\nline-proxy,50 vertices,51,2.1,"));
  EXPECT_NE(csv.find("\npoint-shell,scale 4,4700,3.2,5.44,1000,312500,,999\n"), std::string::npos) << csv;
  const std::string html = bytes_of(page);
  EXPECT_EQ(html.find("least number of vertices"), std::string::npos);
  EXPECT_NE(html.find("14 of the 14 resolutions hold 950 Hz or more in a loop of 1000 Hz here by their CPU "
                      "time, and 13 "),
            std::string::npos);
  EXPECT_NE(html.find("51 to 484 times as many steps"), std::string::npos);
  EXPECT_NE(html.find("an early tick waits for its millisecond"), std::string::npos);
  EXPECT_EQ(testing_support::without_namespaces(html).find("http"), std::string::npos);
}

TEST_F(ReportTest, DrawsRatesOfAnyNameAndRefusesMissingRates) {
  MeasuredRates measured{
      {{algorithm_named("point-shell").id, "it's \"coarse\", `x`", 10, 5, 6, 1000, 2e5, 0, 999}}, {}};
  const fs::path page = write_rates_report(measured, out_);
  EXPECT_NE(bytes_of(page).find("Steps a second against resolution"), std::string::npos);
  EXPECT_NE(bytes_of(out_ / "rates.csv").find("\"it's \"\"coarse\"\", `x`\",10"), std::string::npos);
  EXPECT_THROW(write_rates_report({}, out_), InputError);
  measured.rows[0].paced_rate_hz = 0;
  EXPECT_THROW(write_rates_report(measured, out_), InputError);
}

TEST_F(ReportTest, ShowsMinimumVerticesBesideThoseOfThePaper) {
  MeasuredRates measured{sample_rates(), {}};
  for (const int count : {12, 24, 32})
    measured.vertices.push_back({"sphere", count, 2, 5, 0.1, 0.15, count > 12});
  measured.vertices.push_back({"circle", 8, 2, 50, 0.1, 0.15, false});
  const std::string html = bytes_of(write_rates_report(measured, out_));
  EXPECT_NE(
      html.find("24 on the sphere (24 in the paper), none of those tried on the circle (8 in the paper)"),
      std::string::npos);
  EXPECT_NE(bytes_of(out_ / "vertices.csv").find("\nsphere,24,2,5,0.1,0.15,1\n"), std::string::npos);
}

}  // namespace
}  // namespace osteomill
