#include "osteomill/study/study_report.h"

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"
#include "osteomill/study/paper.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTrials = 4;

// Four pushes, with a map for each phase.
StudyDesign sample_design() {
  StudyAxis pushes;
  for (const char* push : {"1", "2", "3", "4"}) pushes.push_back({{"push", push}, {"burr-radius", push}});
  StudyDesign design({}, {pushes}, {});
  for (const std::string_view phase : kPhases)
    design.maps.push_back(
        {.x = "push", .y = "burr-radius", .colour = "force_mean_N", .part = std::string(phase)});
  return design;
}

// Trials of which some did not hold: one was measured, and one lost contact.
StudyFolder sample_study(const TemporaryFolder& folder, std::size_t unreached) {
  const StudyFolder study{folder.path(), {.trials = kTrials, .trials_a_slice = kTrials}};
  Slice slice{.cpu_s = 3};
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    for (std::size_t part = 0; part < kPhases.size(); ++part) {
      TrialRow& row = slice.rows.emplace_back(TrialRow{.trial = trial, .part = part});
      row.run.phase = kPhases[part];
      row.run.metrics.force_N.mean = 1 + 0.1 * static_cast<double>(trial);
      if (kPhases[part] != kHolding || trial >= unreached) continue;
      row.run.not_reached = "the shaft turned by more than 3 degrees";
      if (trial > 0) row.run.metrics.force_N.mean = kNotMeasured;
    }
  }
  write_slice(study, slice);
  return study;
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

std::vector<std::string> captions_of(const std::string& page) {
  const std::string begin = "<figcaption>";
  std::vector<std::string> captions;
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at + 1))
    captions.push_back(page.substr(at, page.find("</figcaption>", at) - at));
  return captions;
}

TEST(StudyReport, CountsAndHatchesUnreachedTrials) {
  const TemporaryFolder folder;
  const StudyFolder study = sample_study(folder, 2);
  const std::string page = text_of(write_study_report(sample_design(), study));
  EXPECT_NE(page.find("4 of 4 trials (100 %)"), std::string::npos);
  EXPECT_NE(page.find(" 2 of the 4 trials did not do all of their test"), std::string::npos);
  const std::vector<std::string> captions = captions_of(page);
  ASSERT_EQ(captions.size(), 2u);
  EXPECT_EQ(count(captions[0], "In hatched cells"), 0u) << "all milled";
  EXPECT_EQ(count(captions[1], "In hatched cells"), 1u);
  const fs::path figures = folder.path() / "report/figures";
  EXPECT_EQ(text_of(figures / "map_1.svg").find("<pattern"), std::string::npos);
  EXPECT_EQ(count(text_of(figures / "map_2.svg"), "url(#gpPat"), 2u) << "a measured cell and a grey one";
}

TEST(StudyReport, DropsUnreachedTrialsAndRefusesIfNoneRemain) {
  const TemporaryFolder folder;
  const StudyFolder study = sample_study(folder, 2);
  const std::string page = text_of(write_study_report(sample_design(), study, Unreached::dropped));
  EXPECT_NE(page.find("they are left out of everything here"), std::string::npos);
  EXPECT_EQ(count(page, "In hatched cells"), 0u);
  const std::string csv = text_of(folder.path() / "report/trials.csv");
  EXPECT_EQ(count(csv, "\n"), 1 + 2 * kPhases.size());
  EXPECT_EQ(csv.find("\n0,"), std::string::npos);
  EXPECT_EQ(csv.find("\n1,"), std::string::npos);
  const TemporaryFolder other;
  const StudyFolder none = sample_study(other, kTrials);
  EXPECT_THROW(write_study_report(sample_design(), none, Unreached::dropped), InputError);
}

TEST(StudyReport, OmitsNoteIfNoTrialIsUnreached) {
  const TemporaryFolder folder;
  const std::string page = text_of(write_study_report(sample_design(), sample_study(folder, 0)));
  EXPECT_EQ(page.find("did not do all of their test"), std::string::npos);
  EXPECT_EQ(count(page, "In hatched cells"), 0u);
}

}  // namespace
}  // namespace osteomill
