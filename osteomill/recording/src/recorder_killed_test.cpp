#include <atomic>
#include <chrono>
#include <csignal>
#include <new>
#include <thread>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"

#include "tests/support/recording_samples.h"
#include "tests/wait.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;

// Number of records pushed, in memory shared with the child.
class SharedCount {
 public:
  SharedCount()
      : place_(::mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS,
                      -1, 0)) {
    count_ = new (place_) std::atomic<int>(0);
  }
  ~SharedCount() { ::munmap(place_, sizeof(std::atomic<int>)); }
  SharedCount(const SharedCount&) = delete;
  SharedCount& operator=(const SharedCount&) = delete;
  std::atomic<int>& operator*() { return *count_; }

 private:
  void* place_;
  std::atomic<int>* count_;
};

[[noreturn]] void record_forever(const std::filesystem::path& path, std::atomic<int>& pushed) {
  Recorder recorder(path, sample_description());
  for (int tick = 0;; ++tick) {
    recorder.push_waiting(sample_record(tick));
    pushed.store(tick + 1);
    if (tick % 5 == 0) std::this_thread::sleep_for(1ms);
  }
}

TEST(KilledRecorder, LeavesAReadableRecordingMissingAtMostOneSecond) {
  const TestFolder folder;
  for (int round = 0; round < 3; ++round) {
    SharedCount pushed;
    const pid_t child = ::fork();
    if (child == 0) record_forever(folder / "run.h5", *pushed);
    const bool records = becomes_true_in_time([&] { return (*pushed).load() >= 200; });
    const int well_before = (*pushed).load();
    // At most the last second is lost; the rounds kill at different times between two flushes.
    std::this_thread::sleep_for(1000ms + round * 37ms);
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(records) << "only " << well_before << " records were pushed";
    ASSERT_TRUE(WIFSIGNALED(status));

    EXPECT_FALSE(std::filesystem::exists(folder / "run.h5"));
    const Recording read = read_recording(unfinished_recording_path(folder / "run.h5"));
    EXPECT_FALSE(read.complete);
    EXPECT_EQ(read.description.settings, sample_description().settings);
    EXPECT_GE(static_cast<int>(read.records.size()), well_before);
    for (std::size_t n = 0; n < read.records.size(); ++n) {
      ASSERT_TRUE(same_bits(read.records[n], sample_record(static_cast<int>(n)))) << n;
    }
  }
}

}  // namespace
}  // namespace osteomill
