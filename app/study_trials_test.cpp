#include "app/study_trials.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "osteomill/base/temporary_folder.h"
#include "osteomill/ct/write_nrrd.h"
#include "osteomill/volume/density_grid.h"

#include "tests/shapes.h"

namespace osteomill::app {
namespace {

TEST(StudyTrials, SetsEveryFieldFromItsAxis) {
  std::set<std::string> options;
  for (const Field<TrialSpec>& field : trial_number_fields()) {
    EXPECT_TRUE(options.insert(field.option).second) << field.option << " is there twice";
    if (!field.choices.empty()) {
      const std::string& last = field.choices.back();
      EXPECT_EQ(field.get(trial_spec({{field.option, last}})), static_cast<double>(field.choices.size() - 1));
      continue;
    }
    const bool is_switch = field.range == NumberRange::on_or_off();
    const double usual = std::max(0.75, 1.5 * field.range.min) + (field.range.whole ? 2.25 : 0);
    const double value = is_switch ? 1 : usual;
    const std::string text = is_switch ? "true" : fmt::format("{}", value);
    EXPECT_EQ(field.get(trial_spec({{field.option, text}})), value) << field.option;
    EXPECT_NE(field.get(TrialSpec()), value) << field.option;
  }
  EXPECT_GT(options.size(), 20u);
}

TEST(StudyTrials, RefusesNonFiniteNumbersAndWords) {
  for (const Field<TrialSpec>& field : trial_number_fields()) {
    for (const char* text : {"nan", "-nan", "inf", "push", ""})
      EXPECT_THROW(trial_spec({{field.option, text}}), std::invalid_argument) << field.option << " " << text;
  }
  EXPECT_ANY_THROW(trial_spec({{"stiffness", "nan"}}));
  EXPECT_ANY_THROW(trial_spec({{"line-proxy.stiffness", "nan"}}));
  EXPECT_THROW(trial_spec({{"algorithm", "nan"}}), std::invalid_argument);
  EXPECT_THROW(trial_spec({{"entry", "1,2,nan"}}), std::invalid_argument);
}

class StudyOfScans : public ::testing::Test {
 protected:
  StudyOfScans() {
    for (const double radius_mm : {4.0, 5.0}) {
      const Volume bone = testing_support::shape_volume(testing_support::centred_cube(50, 0.25),
                                                        testing_support::ball(Vec3::Zero(), radius_mm));
      const std::string name = fmt::format("ball-{:g}.nrrd", radius_mm);
      write_nrrd(folder_ / name, bone.grid());
    }
  }

  // Returns the fingerprints of the bones of all trials of a study with these axes.
  std::vector<std::uint64_t> bones_of(const std::string& axes) {
    std::ofstream(folder_ / "study.toml") << "[fixed]\nseconds = 1\n" << axes;
    StudyTrials study((folder_ / "study.toml").string(), folder_.path());
    std::vector<std::uint64_t> bones;
    for (std::size_t n = 0; n < study.design().trial_count(); ++n)
      bones.push_back(fingerprint_of(study.make(n, 1).front().bone.grid()));
    return bones;
  }

  TemporaryFolder folder_;
};

// Regardless of the other settings and of the order of the trials.
TEST_F(StudyOfScans, GivesEachTrialTheBoneOfItsAxes) {
  const std::vector<std::uint64_t> bones = bones_of(
      "[grid]\niso = [500, 600]\npush = [1, 2]\nscan = [\"ball-4.nrrd\", \"ball-5.nrrd\", \"built-in\"]\n");
  ASSERT_EQ(bones.size(), 12u);
  for (std::size_t n = 0; n < bones.size(); ++n) EXPECT_EQ(bones[n], bones[n % 3]) << n;
  EXPECT_EQ(std::set(bones.begin(), bones.end()).size(), 3u);
  const std::vector<std::uint64_t> teeth = bones_of("[grid]\nvoxel = [0.25, 0.5]\npush = [1, 2]\n");
  EXPECT_EQ(teeth[0], teeth[1]);
  EXPECT_NE(teeth[0], teeth[2]);
  EXPECT_EQ(teeth[2], teeth[3]);
}

TEST_F(StudyOfScans, BoneKeyDiffersForBoneFieldsOnly) {
  std::size_t reported = 0;
  for (const auto& field : trial_text_fields()) {
    const bool of_the_bone = field.has(kBoneField);
    const std::string value = field.option == "as"          ? "labels"
                              : "algorithm" == field.option ? "line-proxy"
                                                            : "1,2,3";
    EXPECT_EQ(bone_key(trial_spec({{field.option, value}})) != bone_key({}), of_the_bone) << field.option;
    reported += of_the_bone ? 1 : 0;
  }
  EXPECT_EQ(reported, 7u);
  EXPECT_NE(bone_key(trial_spec({{"iso", "300"}})), bone_key(trial_spec({{"iso", "400"}})));
  EXPECT_EQ(bone_key(trial_spec({{"push", "2"}, {"burr-radius", "2"}})), bone_key({}));
}

}  // namespace
}  // namespace osteomill::app
