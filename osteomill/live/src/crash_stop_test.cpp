#include "osteomill/live/crash_stop.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/base/signal_cleanup.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/live/haptic_thread.h"

#include "tests/descending_device.h"
#include "tests/shapes.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;

// The part of a device's state that another process can see.
struct SharedWrench {
  std::atomic<double> force_N;
  std::atomic<double> max_N;
};

// Force on the hand before the crash, N.
constexpr double kPressed_N = 0.2;

class SharedDevice : public testing_support::DescendingDevice {
 public:
  SharedDevice(SharedWrench* sent, void (*crash)()) : DescendingDevice(1.2), sent_(sent), crash_(crash) {}
  Pose read_pose() override {
    if (crash_ != nullptr && sent_->max_N >= kPressed_N) crash_();
    return DescendingDevice::read_pose();
  }
  void write_wrench(const Wrench& wrench) override {
    sent_->force_N = is_let_go_ ? 0 : wrench.force_N.norm();
    sent_->max_N = std::max<double>(sent_->max_N, sent_->force_N);
  }
  bool disengage() noexcept override {
    is_let_go_ = true;
    sent_->force_N = 0;
    return true;
  }
  void engage() noexcept override { is_let_go_ = false; }

 private:
  SharedWrench* sent_;
  void (*crash_)();
  std::atomic<bool> is_let_go_{false};
};

// How a process ends: by a signal from another process, or by an action of the main or the haptic thread.
struct Ending {
  int signal;
  void (*main_thread)() = nullptr;
  void (*haptic_thread)() = nullptr;
  bool replaces_its_session = false;
  bool removes_leftovers = false;
};

std::unique_ptr<HapticThread> live_on(const Volume& bone, Device& device) {
  return std::make_unique<HapticThread>(
      std::make_unique<MillingSession>(std::make_shared<Volume>(bone), BoneDensities{0, 1000},
                                       MillingSetup{.algorithm = algorithm_named("point-shell")}),
      device);
}

Volume flat_bone() {
  return testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                       testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
}

void overflow_the_stack() {
  volatile char much[1 << 20];
  much[0] = 1;
  if (much[0] == 1) overflow_the_stack();
  much[1] = 1;
}

[[noreturn]] void run_live(SharedWrench* sent, const Ending& end) {
  const Volume bone = flat_bone();
  if (end.removes_leftovers) install_signal_cleanup();
  const CrashStop crash_stop;
  SharedDevice device(sent, end.haptic_thread);
  std::unique_ptr<HapticThread> live = live_on(bone, device);
  // Makes the new session while the old one exists, as a program does that opens another bone.
  if (end.replaces_its_session) {
    live->start();
    live = live_on(bone, device);
    device.lift();
  }
  live->start();
  for (int n = 0; n < 12000 && sent->max_N < kPressed_N; ++n) std::this_thread::sleep_for(5ms);
  if (end.main_thread != nullptr) end.main_thread();
  // Longer than a busy machine may take until the process is ended.
  std::this_thread::sleep_for(120s);
  _exit(0);
}

class CrashStopTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kMaxProcesses = 32;
  void SetUp() override {
    void* shared = mmap(nullptr, kMaxProcesses * sizeof(SharedWrench), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(shared, MAP_FAILED);
    sent_ = new (shared) SharedWrench[kMaxProcesses];
  }
  void TearDown() override { munmap(sent_, kMaxProcesses * sizeof(SharedWrench)); }

  pid_t begin(std::size_t n, const Ending& end) {
    const pid_t child = fork();
    if (child == 0) run_live(&sent_[n], end);
    return child;
  }
  // Up to a minute, because ticks under a sanitizer are late.
  void await_pressing(std::size_t n) const {
    for (int k = 0; k < 12000 && sent_[n].max_N < kPressed_N; ++k) std::this_thread::sleep_for(5ms);
  }
  // Runs two processes at a time. If all ran at once on one or two cores, ticks under a thread sanitizer
  // would be so late that the last processes would time out before their turn.
  void expect_zero_after(std::span<const Ending> ends) {
    for (std::size_t n = 0; n < ends.size(); n += 2) {
      const std::size_t end = std::min(n + 2, ends.size());
      std::array<pid_t, 2> children{};
      for (std::size_t k = n; k < end; ++k) children[k - n] = begin(k, ends[k]);
      for (std::size_t k = n; k < end; ++k) expect_zero_after(k, children[k - n], ends[k]);
    }
  }
  void expect_zero_after(std::size_t n, pid_t child, const Ending& end) {
    if (end.main_thread == nullptr && end.haptic_thread == nullptr) {
      await_pressing(n);
      kill(child, end.signal);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_GE(sent_[n].max_N, kPressed_N) << n;
    EXPECT_EQ(sent_[n].force_N, 0) << strsignal(end.signal);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    // Sanitizers end a crashed program in their own way.
    EXPECT_NE(status, 0);
#else
    EXPECT_EQ(WIFSIGNALED(status) ? WTERMSIG(status) : 0, end.signal);
#endif
  }

  SharedWrench* sent_ = nullptr;
};

TEST_F(CrashStopTest, AnyFatalSignalLeavesTheWrenchAtZero) {
  const std::vector<Ending> ends{{SIGSEGV}, {SIGBUS},  {SIGFPE},  {SIGILL},   {SIGABRT},   {SIGSYS},
                                 {SIGTRAP}, {SIGQUIT}, {SIGTERM}, {SIGHUP},   {SIGINT},    {SIGXCPU},
                                 {SIGXFSZ}, {SIGPIPE}, {SIGALRM}, {SIGPROF},  {SIGVTALRM}, {SIGUSR1},
                                 {SIGUSR2}, {SIGPOLL}, {SIGPWR},  {SIGSTKFLT}};
  expect_zero_after(ends);
}

TEST_F(CrashStopTest, CrashInAnyThreadLeavesTheWrenchAtZero) {
  const std::vector<Ending> ends {
    {SIGSEGV, [] { raise(SIGSEGV); }}, {SIGABRT, [] { std::abort(); }},
        {SIGSEGV, nullptr, [] { raise(SIGSEGV); }},
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        {SIGSEGV, [] { overflow_the_stack(); }}, {SIGSEGV, nullptr, [] { overflow_the_stack(); }},
#endif
  };
  expect_zero_after(ends);
}

TEST_F(CrashStopTest, TerminationWithCleanupLeavesTheWrenchAtZero) {
  const std::vector<Ending> ends{{.signal = SIGTERM, .removes_leftovers = true},
                                 {.signal = SIGINT, .removes_leftovers = true},
                                 {.signal = SIGHUP, .removes_leftovers = true}};
  expect_zero_after(ends);
}

// Ctrl-Z, and terminal access from a background process.
TEST_F(CrashStopTest, WrenchIsZeroWhileStoppedAndReturnsOnContinue) {
  const int stops[] = {SIGTSTP, SIGTTIN, SIGTTOU};
  for (std::size_t n = 0; n < 3; ++n) {
    const pid_t child = begin(n, {});
    await_pressing(n);
    kill(child, stops[n]);
    int status = 0;
    waitpid(child, &status, WUNTRACED);
    EXPECT_TRUE(WIFSTOPPED(status)) << strsignal(stops[n]);
    EXPECT_EQ(sent_[n].force_N, 0) << strsignal(stops[n]);
    kill(child, SIGCONT);
    for (int k = 0; k < 2000 && sent_[n].force_N < kPressed_N; ++k) std::this_thread::sleep_for(1ms);
    EXPECT_GE(sent_[n].force_N, kPressed_N);
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
  }
}

TEST_F(CrashStopTest, EndingAReplacementSessionLeavesTheWrenchAtZero) {
  const std::vector<Ending> ends{
      {.signal = SIGTERM, .replaces_its_session = true},
      {.signal = SIGSEGV, .main_thread = [] { raise(SIGSEGV); }, .replaces_its_session = true}};
  expect_zero_after(ends);
}

struct sigaction action_of(int signal) {
  struct sigaction action {};
  sigaction(signal, nullptr, &action);
  return action;
}

std::atomic<int> host_calls{0};
void count_call(int) {
  host_calls.fetch_add(1);
}

// A host's own handler, restored at the end.
class HostHandler {
 public:
  explicit HostHandler(int signal) : signal_(signal), before_(action_of(signal)) {
    struct sigaction action {};
    action.sa_handler = &count_call;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
    host_calls = 0;
  }
  ~HostHandler() { sigaction(signal_, &before_, nullptr); }
  HostHandler(const HostHandler&) = delete;
  HostHandler& operator=(const HostHandler&) = delete;
  bool is_in_force() const { return action_of(signal_).sa_handler == &count_call; }

 private:
  int signal_;
  struct sigaction before_;
};

class HostTest : public ::testing::Test {
 protected:
  // Runs some ticks of a live session while `signals` sends signals.
  void run(const std::function<void()>& signals) {
    const std::unique_ptr<HapticThread> live = live_on(bone_, device_);
    live->start();
    signals();
    const auto ticks = live->timing().ticks;
    for (int n = 0; n < 2000 && live->timing().ticks < ticks + 20; ++n) std::this_thread::sleep_for(5ms);
    EXPECT_GE(live->timing().ticks, ticks + 20);
    EXPECT_TRUE(live->is_running());
  }
  Volume bone_ = flat_bone();
  SharedWrench sent_{};
  SharedDevice device_{&sent_, nullptr};
};

TEST_F(HostTest, SessionWithoutCrashStopInstallsNoHandlers) {
  run([] {
    for (const int signal : {SIGTERM, SIGINT, SIGSEGV, SIGUSR1, SIGPROF, SIGTSTP, SIGPIPE}) {
      const struct sigaction now = action_of(signal);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
      EXPECT_TRUE(now.sa_handler == SIG_DFL || now.sa_handler == SIG_IGN) << strsignal(signal);
#else
      EXPECT_TRUE(signal == SIGSEGV || now.sa_handler == SIG_DFL || now.sa_handler == SIG_IGN);
#endif
    }
  });
}

TEST_F(HostTest, LeavesSignalsThatTheHostHandlesToTheHost) {
  for (const int signal : {SIGUSR1, SIGTSTP, SIGPIPE, SIGIO, SIGHUP, SIGTERM}) {
    const HostHandler host(signal);
    const CrashStop crash_stop;
    run([signal] { raise(signal); });
    EXPECT_EQ(host_calls, 1) << strsignal(signal);
  }
}

TEST_F(HostTest, ProfilingTimerLeavesTheLoopRunning) {
  const HostHandler host(SIGPROF);
  const CrashStop crash_stop;
  run([] {
    const itimerval every_ms{{0, 1000}, {0, 1000}};
    setitimer(ITIMER_PROF, &every_ms, nullptr);
    // The timer counts CPU time.
    const auto start = std::chrono::steady_clock::now();
    while (host_calls < 10 && std::chrono::steady_clock::now() - start < 20s) {
    }
    const itimerval never{};
    setitimer(ITIMER_PROF, &never, nullptr);
  });
  EXPECT_GE(host_calls, 10);
}

TEST_F(HostTest, LastCrashStopRestoresThePreviousHandlers) {
  const struct sigaction before = action_of(SIGTERM);
  auto first = std::make_unique<CrashStop>();
  auto second = std::make_unique<CrashStop>();
  EXPECT_NE(action_of(SIGTERM).sa_sigaction, before.sa_sigaction);
  first.reset();
  EXPECT_NE(action_of(SIGTERM).sa_sigaction, before.sa_sigaction);
  second.reset();
  EXPECT_EQ(action_of(SIGTERM).sa_sigaction, before.sa_sigaction);
}

TEST_F(HostTest, KeepsAHandlerThatTheHostSetsLater) {
  auto crash_stop = std::make_unique<CrashStop>();
  const HostHandler host(SIGUSR2);
  crash_stop.reset();
  EXPECT_TRUE(host.is_in_force());
}

}  // namespace
}  // namespace osteomill
