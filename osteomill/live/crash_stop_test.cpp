#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "tests/shapes.h"
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/live/live_session.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;

// What another process can see of a device.
struct Sent {
  double force_N;
  double max_N;
};

// What is felt before it crashes.
constexpr double kPressed_N = 0.2;

class SharedDevice : public Device {
 public:
  SharedDevice(Sent* sent, bool crashes) : sent_(sent), crashes_(crashes) {}
  Pose read_pose() override {
    if (crashes_ && sent_->max_N >= kPressed_N) raise(SIGSEGV);
    return {{0, 0, 1.2}, Quat::Identity()};
  }
  void write_wrench(const Wrench& wrench) override {
    sent_->force_N = wrench.force_N.norm();
    sent_->max_N = std::max(sent_->max_N, sent_->force_N);
  }

 private:
  Sent* sent_;
  bool crashes_;
};

[[noreturn]] void run_live(Sent* sent, bool device_crashes, void (*crash)()) {
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                                    testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  SharedDevice device(sent, device_crashes);
  LiveSession live(
      std::make_unique<MillingSession>(std::make_shared<Volume>(bone), BoneDensities{0, 1000},
                                       MillingSetup{.algorithm = algorithm_named("point-shell")}),
      device);
  live.start();
  for (int n = 0; n < 2000 && sent->max_N < kPressed_N; ++n) std::this_thread::sleep_for(5ms);
  crash();
  std::this_thread::sleep_for(1s);
  _exit(0);
}

class CrashStopTest : public ::testing::Test {
 protected:
  void SetUp() override {
    void* shared = mmap(nullptr, sizeof(Sent), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(shared, MAP_FAILED);
    sent_ = static_cast<Sent*>(shared);
  }
  void TearDown() override { munmap(sent_, sizeof(Sent)); }

  // The signal that the process died of.
  int run(bool device_crashes, void (*crash)(), [[maybe_unused]] int expected) {
    const pid_t child = fork();
    if (child == 0) run_live(sent_, device_crashes, crash);
    int status = 0;
    waitpid(child, &status, 0);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    // Sanitizers end a crashed program in their own way.
    if (status != 0) return expected;
#endif
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }

  Sent* sent_ = nullptr;
};

TEST_F(CrashStopTest, ACrashOfAnotherThreadLeavesTheWrenchAtZero) {
  EXPECT_EQ(run(
                false, [] { raise(SIGSEGV); }, SIGSEGV),
            SIGSEGV);
  EXPECT_GE(sent_->max_N, kPressed_N);
  EXPECT_EQ(sent_->force_N, 0);
}

TEST_F(CrashStopTest, SoDoesAnExceptionThatNobodyCatches) {
  EXPECT_EQ(run(
                false, [] { std::abort(); }, SIGABRT),
            SIGABRT);
  EXPECT_GE(sent_->max_N, kPressed_N);
  EXPECT_EQ(sent_->force_N, 0);
}

TEST_F(CrashStopTest, SoDoesARequestToEnd) {
  EXPECT_EQ(run(
                false, [] { kill(getpid(), SIGTERM); }, SIGTERM),
            SIGTERM);
  EXPECT_GE(sent_->max_N, kPressed_N);
  EXPECT_EQ(sent_->force_N, 0);
}

TEST_F(CrashStopTest, SoDoesACrashOfTheHapticThreadItself) {
  EXPECT_EQ(run(
                true, [] {}, SIGSEGV),
            SIGSEGV);
  EXPECT_GE(sent_->max_N, kPressed_N);
  EXPECT_EQ(sent_->force_N, 0);
}

}  // namespace
}  // namespace osteomill
