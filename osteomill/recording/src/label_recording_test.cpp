#include <gtest/gtest.h>

#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"

#include "tests/support/recording_samples.h"

namespace osteomill {
namespace {

using namespace testing_support;

RunDescription with_labels() {
  RunDescription run = sample_description();
  run.labels = {
      {-3, "bone", {1, 2, 3}}, {200, "Nervus facialis \xc3\xa4", {255, 254, 253}, true}, {7, "", {}}};
  return run;
}

// Every third tick cuts, some of them two labels.
TickRecord cutting_tick(int n) {
  TickRecord record = sample_record(n);
  if (n % 3 == 0) record.label_cuts[0] = {static_cast<LabelMap::LabelIndex>(1 + n % 2), 0.1 * n};
  if (n % 9 == 0) record.label_cuts[1] = {3, 0};
  return record;
}

TEST(LabelRecording, PreservesLabelsAndEveryLabelCut) {
  const TestFolder folder;
  constexpr int kTicks = 3000;
  {
    Recorder recorder(folder / "run.h5", with_labels());
    for (int n = 0; n < kTicks; ++n) recorder.push_waiting(cutting_tick(n));
    recorder.close();
  }
  const Recording recording = read_recording(folder / "run.h5");
  EXPECT_EQ(recording.description.labels, with_labels().labels);
  ASSERT_EQ(recording.records.size(), static_cast<std::size_t>(kTicks));
  for (int n = 0; n < kTicks; ++n) {
    ASSERT_EQ(recording.records[static_cast<std::size_t>(n)].label_cuts, cutting_tick(n).label_cuts) << n;
  }
}

TEST(LabelRecording, ReadsLabelCutsFromAnUnfinishedFile) {
  const TestFolder folder;
  {
    Recorder recorder(folder / "run.h5", with_labels());
    for (int n = 0; n < 100; ++n) recorder.push_waiting(cutting_tick(n));
  }
  const Recording recording = read_recording(folder / "run.part.h5");
  EXPECT_FALSE(recording.complete);
  EXPECT_EQ(recording.records.at(99).label_cuts, cutting_tick(99).label_cuts);
}

TEST(LabelRecording, HasNoLabelCutsWithoutLabels) {
  const TestFolder folder;
  {
    Recorder recorder(folder / "run.h5", sample_description());
    for (int n = 0; n < 10; ++n) recorder.push_waiting(cutting_tick(n));
    recorder.close();
  }
  const Recording recording = read_recording(folder / "run.h5");
  EXPECT_TRUE(recording.description.labels.empty());
  EXPECT_EQ(recording.records.front().label_cuts, LabelCuts{});
}

}  // namespace
}  // namespace osteomill
