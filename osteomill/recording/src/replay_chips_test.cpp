#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/density_grid.h"

#include "tests/shapes.h"
#include "tests/support/recording_samples.h"

namespace osteomill {
namespace {

const SessionSettings kSettings{{.law = CuttingLaw::chips,
                                 .burr = BurrEdge::cutting,
                                 .wear_cuts = 7,
                                 .handpiece = Handpiece::surgical,
                                 .cutting_reaction = true,
                                 .drag = true,
                                 .vibration = {true, 0.1, 0.4}},
                                {0, 1000}};

// Two sessions, of which the second begins with the spindle still turning.
TEST(ReplayChips, ReplaysSpindleDragAndVibrationBitIdentically) {
  const testing_support::TestFolder folder;
  const Volume scan = testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                                    testing_support::ball(Vec3::Zero(), 5));
  const RunDescription run = describe_run(scan, {"ball", fingerprint_of(scan.grid())}, kSettings, 0);
  auto bone = std::make_shared<Volume>(scan);
  auto session = std::make_unique<MillingSession>(bone, kSettings.densities, kSettings.setup);
  Recorder recorder(folder / "run.h5", run);
  PosedDevice device;
  const auto press = [&](int first, int last, std::uint32_t number) {
    for (int n = first; n < last; ++n) {
      device.put({{0.001 * n, 0, 7.0 - std::min(0.01 * n, 4.5)}, Quat::Identity()});
      TickRecord record =
          session->tick(device, {.time_s = 1e-3 * n, .dt_s = 1e-3, .spindle_on = n % 300 < 280});
      record.session = number;
      recorder.push_waiting(record);
    }
  };
  press(0, 700, 0);
  const SessionHandover before = session->handover();
  EXPECT_GT(before.spindle_rpm, 1000);
  const double removed_mm3 = session->removed_mm3();
  EXPECT_GT(removed_mm3, 0.05);
  bone = std::make_shared<Volume>(*bone);
  session = std::make_unique<MillingSession>(bone, kSettings.densities, kSettings.setup);
  session->count_removed_from(removed_mm3);
  session->resume_from(before);
  recorder.begin_session(1, {run, before, removed_mm3, differing_blocks(bone->grid(), scan.grid()), ""});
  press(700, 1000, 1);
  recorder.close();

  const Recording recording = read_recording(folder / "run.h5");
  EXPECT_EQ(recording.sessions[1].start.handover.spindle_rpm, before.spindle_rpm);
  const Verification verified = verify_recording(scan, recording);
  EXPECT_FALSE(verified.difference) << verified.difference->record << ": " << verified.difference->what;
  EXPECT_EQ(verified.ticks, 1000u);
  Volume again = scan;
  repeat_milling(again, recording);
  EXPECT_EQ(again.grid().densities(), bone->grid().densities());
}

TEST(ReplayChips, UsesConstantEnergyAndSpeedForOlderRecordings) {
  RunDescription run = describe_run(testing_support::shape_volume(testing_support::centred_cube(10, 0.25),
                                                                  testing_support::ball(Vec3::Zero(), 1)),
                                    {"ball", 0}, kSettings, 0);
  std::erase_if(run.settings, [](const RunSetting& setting) {
    return setting.key == "milling.law" || setting.key == "spindle.handpiece" ||
           setting.key == "milling.wear" || setting.key == "milling.burr" || setting.key == "milling.drag";
  });
  const MillingSetup setup = session_settings(run, "run.h5").setup;
  EXPECT_EQ(setup.law, CuttingLaw::constant_energy);
  EXPECT_EQ(setup.handpiece, Handpiece::none);
  EXPECT_FALSE(setup.drag);
}

}  // namespace
}  // namespace osteomill
