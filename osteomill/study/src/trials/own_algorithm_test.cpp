// A program that links the library defines its own algorithm and compares it with the paper's.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/base/temporary_folder.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recording.h"
#include "osteomill/study/comparison_report.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/run_trials.h"
#include "osteomill/volume/builtin_tooth.h"

namespace osteomill {
namespace {

// A cushion at a height: a spring pushes the burr's centre up.
class Cushion final : public HapticAlgorithm {
 public:
  Cushion(double stiffness_N_per_mm, double height_mm)
      : stiffness_N_per_mm_(stiffness_N_per_mm), height_mm_(height_mm) {}
  void prepare(const AlgorithmInputs&) override {}
  HapticStep step(const Pose& X_WD, double) noexcept override {
    HapticStep step;
    step.X_WT = X_WD;
    const double depth_mm = height_mm_ - X_WD.position_mm.z();
    if (depth_mm > 0) step.wrench.force_N.z() = stiffness_N_per_mm_ * depth_mm;
    step.contacts = depth_mm > 0 ? 1 : 0;
    return step;
  }
  void volume_changed(const VolumeChange&) noexcept override {}
  void reset() noexcept override {}
  int sample_point_count() const override { return 1; }

 private:
  double stiffness_N_per_mm_;
  double height_mm_;
};

AlgorithmDescription cushion(double height_mm) {
  AlgorithmDescription description;
  description.id = {"cushion", "9 cushion", "#8e24aa"};
  description.settings = {{{.name = "spring",
                            .unit = "N/mm",
                            .range = NumberRange::positive(),
                            .doc = "How stiff it is",
                            .option = "stiffness"},
                           2}};
  description.make = [height_mm](std::span<const double> values) {
    return std::make_unique<Cushion>(values[0], height_mm);
  };
  return description;
}

TEST(OwnAlgorithm, IsRunRecordedAndReportedBesideAPublishedOne) {
  const Volume bone(builtin_tooth(0.5), kBuiltinToothIsovalue);
  TrialSettings settings;
  settings.hand_and_device.script.milling_s = 4;
  settings.hand_and_device.script.holding_s = 0.5;
  TrialPlan plan{bone,
                 {"built-in tooth", fingerprint_of(bone.grid())},
                 estimate_densities(bone),
                 place_entry(bone, settings.tool),
                 settings,
                 "my_program"};
  const TemporaryFolder folder;
  const RunEvents quiet;
  const EntryPictures pictures(bone, plan.densities.reference, plan.entry, quiet);
  std::vector<Recording> recordings;
  for (const AlgorithmDescription& algorithm :
       {cushion(plan.entry.point_W.z()), algorithm_named("line-proxy")}) {
    plan.settings.algorithm = algorithm;
    for (const auto& path : record_trial(plan, pictures, folder.path(), quiet)) {
      recordings.push_back(read_recording(path));
    }
  }
  ASSERT_EQ(recordings.size(), 4u);
  EXPECT_EQ(recordings[0].description.algorithm.label, "9 cushion");
  EXPECT_EQ(recordings[0].description.phase, kMilling);
  double max_force_N = 0;
  for (const TickRecord& tick : recordings[0].records)
    max_force_N = std::max(max_force_N, tick.wrench.force_N.z());
  EXPECT_GT(max_force_N, 0.3);

  const auto page = write_comparison_report(recordings, folder / "report");
  std::ifstream in(page);
  const std::string html{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_NE(html.find("9 cushion"), std::string::npos);
  // The page embeds its figures; #8e24aa as gnuplot writes it.
  std::ifstream figure(folder / "report/figures/fig7_force.svg");
  const std::string svg{std::istreambuf_iterator<char>(figure), std::istreambuf_iterator<char>()};
  EXPECT_NE(svg.find("rgb(142,  36, 170)"), std::string::npos);
  // The paper's findings need its three algorithms.
  EXPECT_NE(html.find("further findings belong to algorithms, phases or grips"), std::string::npos);
}

TEST(OwnAlgorithm, TakesTheSharedOptionsItNames) {
  HapticSettings settings;
  settings.set_option("stiffness", 0.7);
  EXPECT_EQ(setting_values(cushion(0), settings).at(0).value, 0.7);
  settings.clear_option("stiffness");
  EXPECT_EQ(setting_values(cushion(0), settings).at(0).value, 2);
  settings.set_option("stiffness", -1);
  EXPECT_THROW(make_algorithm(cushion(0), settings), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
