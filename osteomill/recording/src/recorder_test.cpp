#include "osteomill/recording/recorder.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/view_sample.h"

#include "recording_file.h"
#include "tests/support/recording_samples.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define OSTEOMILL_COUNTS_ALLOCATIONS 0
#else
#define OSTEOMILL_COUNTS_ALLOCATIONS 1
namespace {
thread_local long allocations_here = 0;
}
// Intercepts every allocation of this program (the sanitizers have their own hooks).
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* malloc(std::size_t size) {
  ++allocations_here;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations_here;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++allocations_here;
  return __libc_realloc(old, size);
}
}
#endif

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

void expect_same(const RunDescription& a, const RunDescription& b) {
  EXPECT_EQ(a.program_version, b.program_version);
  EXPECT_EQ(a.scan_name, b.scan_name);
  EXPECT_EQ(a.dims, b.dims);
  EXPECT_EQ(a.spacing_mm, b.spacing_mm);
  EXPECT_EQ(a.isovalue, b.isovalue);
  EXPECT_EQ(a.tool.burr_radius_mm, b.tool.burr_radius_mm);
  EXPECT_EQ(a.tool.shaft_radius_mm, b.tool.shaft_radius_mm);
  EXPECT_EQ(a.tool.shaft_length_mm, b.tool.shaft_length_mm);
  EXPECT_EQ(a.algorithm, b.algorithm);
  EXPECT_EQ(a.phase, b.phase);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.tick_period_s, b.tick_period_s);
  EXPECT_EQ(a.settings, b.settings);
}

// An hour of recording has some 7000 flushes.
TEST(RecordingFile, MemoryDoesNotGrowWithItsLength) {
  const TestFolder folder;
  RecordingFile file(folder.path() / "long.h5", sample_description());
  std::vector<TickRecord> second(1000);
  const auto seconds = [&](int count) {
    for (int n = 0; n < count; ++n) {
      for (TickRecord& record : second) record = sample_record(static_cast<int>(file.rows()));
      file.append(second);
      file.flush(0);
    }
    return static_cast<double>(::mallinfo2().uordblks);
  };
  const double before = seconds(30);
  EXPECT_LT(seconds(60), before + 0.5e6);
}

TEST(Recorder, RoundTripsRecordsBitIdentically) {
  const TestFolder folder;
  constexpr int kTicks = 5000;  // several chunks and a part of one
  TickRecord odd = sample_record(kTicks);
  odd.wrench.force_N = {-0.0, std::numeric_limits<double>::denorm_min(), -kMaxReal};
  odd.X_WD.position_mm = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                          0};
  const std::vector<unsigned char> png{0x89, 'P', 'N', 'G', 0, 255, 1};
  {
    Recorder recorder(folder / "run.h5", sample_description());
    for (int tick = 0; tick < kTicks; ++tick) recorder.push_waiting(sample_record(tick));
    recorder.push_waiting(odd);
    recorder.add_picture("before", png);
    recorder.add_picture("after", {1});
    recorder.add_setting({std::string(kNotReachedKey), "its end", ""});
    EXPECT_FALSE(fs::exists(folder / "run.h5")) << "the final name is for what is whole";
    recorder.close();
  }
  EXPECT_FALSE(fs::exists(unfinished_recording_path(folder / "run.h5")));
  Recording read = read_recording(folder / "run.h5");
  EXPECT_TRUE(read.complete);
  EXPECT_EQ(read.dropped, 0u);
  EXPECT_EQ(read.description.settings.back(), (RunSetting{std::string(kNotReachedKey), "its end", ""}));
  read.description.settings.pop_back();
  expect_same(read.description, sample_description());
  ASSERT_EQ(read.records.size(), kTicks + 1u);
  for (int tick = 0; tick < kTicks; ++tick) {
    ASSERT_TRUE(same_bits(read.records[static_cast<std::size_t>(tick)], sample_record(tick))) << tick;
  }
  EXPECT_TRUE(same_bits(read.records.back(), odd));
  ASSERT_EQ(read.pictures.size(), 2u);
  EXPECT_EQ(read.pictures[0].name, "after");
  EXPECT_EQ(read.pictures[1].name, "before");
  EXPECT_EQ(read.pictures[1].png, png);
}

TEST(Recorder, RoundTripsEveryFieldOfTheViews) {
  const TestFolder folder;
  const auto sample = [](int n) {
    ViewSample view;
    double value = n;
    for (const Field<ViewSample>& field : fields_of<ViewSample>())
      field.set(view, field.range.max == 1 ? n % 2 : ++value);
    return view;
  };
  {
    Recorder recorder(folder / "run.h5", sample_description());
    for (int n = 0; n < 200; ++n) {
      recorder.push_waiting(sample_record(n));
      recorder.add_view(sample(n));
    }
    recorder.close();
  }
  const Recording read = read_recording(folder / "run.h5");
  ASSERT_EQ(read.views.size(), 200u);
  for (int n = 0; n < 200; ++n) {
    for (const Field<ViewSample>& field : fields_of<ViewSample>())
      ASSERT_EQ(field.get(read.views[static_cast<std::size_t>(n)]), field.get(sample(n))) << field.name;
  }
}

// Paths in Latin-1 and other invalid UTF-8 are valid UTF-8 in the file and survive the round trip.
TEST(Recorder, RoundTripsInvalidUtf8StoredAsValidUtf8) {
  const TestFolder folder;
  for (const std::string name : {"Sch\xE4"
                                 "del.nrrd",
                                 "\xC0\x80\xED\xA0\x80\xF5", "\xE2\x82",
                                 "Sch\xC3\xA4"
                                 "del",
                                 "\xEF\x9F\xA4 \xF0\x9F\xA6\xB4"}) {
    RunDescription run = sample_description();
    run.scan_name = name;
    Recorder(folder / "run.h5", run).close();
    EXPECT_EQ(read_recording(folder / "run.h5").description.scan_name, name);
    fs::remove(folder / "run.h5");
  }
  RunDescription run = sample_description();
  run.scan_name =
      "Sch\xE4"
      "del.nrrd";
  Recorder(folder / "run.h5", run).close();
  std::ifstream file(folder / "run.h5", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(bytes.find("Sch\xEF\x9F\xA4"
                       "del.nrrd"),
            std::string::npos);
}

TEST(Recorder, EmptyRunReadsBackWithoutTicks) {
  const TestFolder folder;
  Recorder(folder / "run.h5", sample_description()).close();
  EXPECT_TRUE(read_recording(folder / "run.h5").records.empty());
}

TEST(Recorder, SessionStartRoundTripsAndInvalidBricksAreRefused) {
  const TestFolder folder;
  SessionStart start{.run = sample_description(), .removed_mm3 = 1.0 / 3};
  start.run.dims = {21, 21, 21};
  start.run.labels = {{7, "nerve", {}, true}};
  // The last one extends beyond the grid.
  for (const VoxelIndex& first : {VoxelIndex{8, 8, 8}, VoxelIndex{16, 0, 16}}) {
    start.bricks.emplace_back().first = first;
    for (float& density : start.bricks.back().densities) density = 0.1f * static_cast<float>(first.k);
  }
  start.bricks[1].densities[3] = -0.125f;
  write_start(folder / "a.h5", start);
  const Recording read = read_recording(folder / "a.h5");
  EXPECT_TRUE(read.complete && read.records.empty());
  ASSERT_EQ(read.sessions.size(), 1u);
  expect_same(read.sessions[0].start.run, start.run);
  EXPECT_EQ(read.sessions[0].start.run.labels, start.run.labels);
  EXPECT_EQ(read.sessions[0].start.removed_mm3, start.removed_mm3);
  ASSERT_EQ(read.sessions[0].start.bricks.size(), 2u);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(read.sessions[0].start.bricks[n].first, start.bricks[n].first);
    EXPECT_EQ(read.sessions[0].start.bricks[n].densities, start.bricks[n].densities);
  }
  const auto refused = [&](const SessionStart& wrong) {
    write_start(folder / "b.h5", wrong);
    EXPECT_THROW(read_recording(folder / "b.h5"), InputError);
  };
  SessionStart wrong = start;
  wrong.bricks[0].densities[7] = std::numeric_limits<float>::quiet_NaN();
  refused(wrong);
  for (const VoxelIndex& first : {VoxelIndex{-8, 0, 0}, VoxelIndex{24, 0, 0}, VoxelIndex{4, 0, 0}}) {
    wrong = start;
    wrong.bricks[1].first = first;
    refused(wrong);
  }
}

// Records are pushed faster than any disk takes them.
TEST(Recorder, CountsTicksDroppedByAFullQueueAndKeepsTheRest) {
  const TestFolder folder;
  std::vector<int> accepted;
  std::uint64_t refused = 0;
  Recorder recorder(folder / "run.h5", sample_description());
  for (int tick = 0; tick < 100000; ++tick) {
    if (recorder.push(sample_record(tick))) {
      accepted.push_back(tick);
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0u);
  EXPECT_GE(accepted.size(), Recorder::kCapacity);
  EXPECT_EQ(recorder.dropped(), refused);
  recorder.close();
  const Recording read = read_recording(folder / "run.h5");
  EXPECT_EQ(read.dropped, refused);
  ASSERT_EQ(read.records.size(), accepted.size());
  for (std::size_t n = 0; n < accepted.size(); ++n) {
    ASSERT_TRUE(same_bits(read.records[n], sample_record(accepted[n])));
  }
}

TEST(Recorder, PushWaitingDropsNothingWhenTheQueueIsFull) {
  const TestFolder folder;
  Recorder recorder(folder / "run.h5", sample_description());
  constexpr int kTicks = 40000;
  for (int tick = 0; tick < kTicks; ++tick) recorder.push_waiting(sample_record(tick));
  recorder.close();
  const Recording read = read_recording(folder / "run.h5");
  EXPECT_EQ(read.dropped, 0u);
  ASSERT_EQ(read.records.size(), std::size_t{kTicks});
  EXPECT_TRUE(same_bits(read.records.back(), sample_record(kTicks - 1)));
}

TEST(Recorder, PushAllocatesNothingEvenWhenFull) {
#if OSTEOMILL_COUNTS_ALLOCATIONS
  const TestFolder folder;
  Recorder recorder(folder / "run.h5", sample_description());
  const TickRecord record = sample_record(1);
  const long before = allocations_here;
  for (int tick = 0; tick < 100000; ++tick) recorder.push(record);
  EXPECT_EQ(allocations_here, before);
  EXPECT_GT(recorder.dropped(), 0u);
  recorder.close();
  EXPECT_GT(allocations_here, before) << "the counter counts nothing";
#else
  GTEST_SKIP() << "the sanitizer has its own malloc";
#endif
}

// For -fsanitize=thread: one thread pushes, one polls, the recorder's own thread writes, and a second
// recorder runs at the same time.
TEST(Recorder, AccountsForEveryTickAcrossConcurrentThreads) {
  const TestFolder folder;
  Recorder recorder(folder / "a.h5", sample_description());
  Recorder other(folder / "b.h5", sample_description());
  std::atomic<std::uint64_t> refused{0};
  std::thread haptic([&] {
    for (int tick = 0; tick < 20000; ++tick) {
      if (!recorder.push(sample_record(tick))) refused.fetch_add(1);
      if (tick % 50 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  });
  std::uint64_t seen = 0;
  for (int tick = 0; tick < 5000; ++tick) {
    other.push_waiting(sample_record(tick));
    EXPECT_GE(recorder.dropped(), seen);
    seen = recorder.dropped();
    EXPECT_FALSE(recorder.failed());
  }
  haptic.join();
  recorder.close();
  other.close();
  const Recording read = read_recording(folder / "a.h5");
  EXPECT_EQ(read.records.size() + read.dropped, 20000u);
  EXPECT_EQ(read.dropped, refused.load());
  for (std::size_t n = 1; n < read.records.size(); ++n) {
    ASSERT_LT(read.records[n - 1].time_s, read.records[n].time_s);
  }
  EXPECT_EQ(read_recording(folder / "b.h5").records.size(), 5000u);
}

TEST(Recorder, LeavesAnUnfinishedRecordingWithoutClose) {
  const TestFolder folder;
  {
    Recorder recorder(folder / "run.h5", sample_description());
    for (int tick = 0; tick < 100; ++tick) recorder.push_waiting(sample_record(tick));
  }
  EXPECT_FALSE(fs::exists(folder / "run.h5"));
  const Recording read = read_recording(unfinished_recording_path(folder / "run.h5"));
  EXPECT_FALSE(read.complete);
  EXPECT_EQ(read.records.size(), 100u);
}

TEST(Recorder, RemovesTheUnfinishedFileWithoutCloseIfRequested) {
  const TestFolder folder;
  {
    Recorder recorder(folder / "run.h5", sample_description(), Recorder::FirstSession::begins_at_once,
                      Recorder::UnfinishedFile::remove);
    recorder.push_waiting(sample_record(0));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Recorder, LocksItsFileAgainstOtherRecordersAndReaders) {
  const TestFolder folder;
  const fs::path path = folder / "run.h5";
  Recorder first(path, sample_description());
  first.push_waiting(sample_record(0));
  EXPECT_THROW(Recorder(path, sample_description()), InputError);
  EXPECT_THROW(read_recording(unfinished_recording_path(path)), InputError);
  first.push_waiting(sample_record(1));
  first.close();
  EXPECT_EQ(read_recording(path).records.size(), 2u);
  EXPECT_FALSE(fs::exists(unfinished_recording_path(path)));
}

TEST(Recorder, KeepsEarlierUnfinishedRecordingsUnderNewNames) {
  const TestFolder folder;
  const fs::path path = folder / "run.h5";
  for (int ticks = 1; ticks <= 3; ++ticks) {
    Recorder recorder(path, sample_description());
    for (int tick = 0; tick < ticks; ++tick) recorder.push_waiting(sample_record(tick));
    EXPECT_EQ(recorder.leftover_note().empty(), ticks == 1);
    if (ticks == 3) recorder.close();
  }
  EXPECT_EQ(read_recording(folder / "run.part-1.h5").records.size(), 1u);
  EXPECT_EQ(read_recording(folder / "run.part-2.h5").records.size(), 2u);
  EXPECT_EQ(read_recording(path).records.size(), 3u);
}

TEST(Recorder, AFolderThatIsMissingIsNamed) {
  const TestFolder folder;
  try {
    Recorder recorder(folder / "none/run.h5", sample_description());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("none/run.part.h5"), std::string::npos) << error.what();
  }
}

TEST(Recorder, RefusesInvalidOrDuplicateKeysAndPictureNames) {
  const TestFolder folder;
  for (const char* key : {"", "x.unit", "twice"}) {
    RunDescription description = sample_description();
    description.settings = {{"twice", 1.0, ""}, {key, 2.0, ""}};
    EXPECT_THROW(Recorder(folder / "run.h5", description), std::invalid_argument) << key;
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  Recorder recorder(folder / "run.h5", sample_description());
  recorder.add_picture("before", {1});
  EXPECT_THROW(recorder.add_picture("before", {1}), std::invalid_argument);
  EXPECT_THROW(recorder.add_picture("../x", {1}), std::invalid_argument);
}

// File size limits simulate full disks; in a child process, because they cannot be lifted again. Everything
// accepted before the disk was full must be readable.
TEST(Recorder, ReportsAFullDiskAndKeepsWrittenRowsReadable) {
  const TestFolder folder;
  std::size_t max_rows = 0;
  for (rlim_t limit_bytes = 400'000; limit_bytes < 6'000'000; limit_bytes += 700'001) {
    const pid_t child = ::fork();
    if (child == 0) {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{limit_bytes, limit_bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      auto recorder = std::make_unique<Recorder>(folder / "run.h5", sample_description());
      bool reported = false;
      try {
        for (int tick = 0; tick < 10'000'000; ++tick) recorder->push_waiting(sample_record(tick));
      } catch (const InputError& error) {
        reported = std::string(error.what()).find("File too large") != std::string::npos;
      }
      bool reported_at_close = false;
      try {
        recorder->close();
      } catch (const InputError&) {
        reported_at_close = true;
      }
      const bool failed = recorder->failed();
      recorder.reset();
      ::_exit(reported && reported_at_close && failed ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    EXPECT_FALSE(fs::exists(folder / "run.h5"));
    // Not even the first ticks fitted.
    if (limit_bytes < 2'000'000 && !fs::exists(unfinished_recording_path(folder / "run.h5"))) continue;
    const Recording recording = read_recording(unfinished_recording_path(folder / "run.h5"));
    for (std::size_t row = 0; row < recording.records.size(); ++row)
      ASSERT_EQ(recording.records[row].X_WT.position_mm,
                sample_record(static_cast<int>(row)).X_WT.position_mm)
          << row << " of " << recording.records.size() << " in " << limit_bytes;
    EXPECT_GE(recording.records.size(), max_rows);
    max_rows = recording.records.size();
  }
  EXPECT_GT(max_rows, 10'000u);
}

}  // namespace
}  // namespace osteomill
