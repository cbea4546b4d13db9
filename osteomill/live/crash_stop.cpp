#include "osteomill/live/crash_stop.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <ctime>
#include <memory>

namespace osteomill {

namespace {

// All that end or stop a process, but those that are never handed to it.
constexpr std::array kSignals{SIGSEGV, SIGBUS,    SIGFPE,  SIGILL,  SIGABRT, SIGSYS,  SIGTRAP,
                              SIGQUIT, SIGTERM,   SIGHUP,  SIGINT,  SIGXCPU, SIGXFSZ, SIGPIPE,
                              SIGALRM, SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGPOLL, SIGSTKFLT,
                              SIGPWR,  SIGTSTP,   SIGTTIN, SIGTTOU};
constexpr bool only_stops(int signal) {
  return signal == SIGTSTP || signal == SIGTTIN || signal == SIGTTOU;
}
constexpr int kWaits = 50;
constexpr timespec kWait{0, 1'000'000};
constexpr std::size_t kStackBytes = 1 << 16;

std::atomic<CrashStop*> the_one{nullptr};
// None is ending a device.
std::atomic<bool> is_over{true};
std::array<struct sigaction, kSignals.size()> actions_before;

// A thread's own, until it ends, where nobody (a sanitizer) has given it one.
class StackOfHandlers {
 public:
  StackOfHandlers() {
    stack_t before{};
    sigaltstack(nullptr, &before);
    if ((before.ss_flags & SS_DISABLE) == 0) return;
    memory_ = std::make_unique<char[]>(kStackBytes);
    stack_t own{};
    own.ss_sp = memory_.get();
    own.ss_size = kStackBytes;
    sigaltstack(&own, nullptr);
  }
  ~StackOfHandlers() {
    if (!memory_) return;
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    sigaltstack(&none, nullptr);
  }
  StackOfHandlers(const StackOfHandlers&) = delete;
  StackOfHandlers& operator=(const StackOfHandlers&) = delete;

 private:
  std::unique_ptr<char[]> memory_;
};

}  // namespace

void CrashStop::give_this_thread_a_stack() {
  thread_local const StackOfHandlers stack;
}

CrashStop::CrashStop(Device& device) : device_(device) {
  give_this_thread_a_stack();
  the_one.store(this);
  is_over.store(false);
  struct sigaction action {};
  action.sa_handler = &CrashStop::handle;
  // One at a time in a thread.
  sigfillset(&action.sa_mask);
  action.sa_flags = SA_ONSTACK | SA_RESTART;
  for (std::size_t n = 0; n < kSignals.size(); ++n) {
    sigaction(kSignals[n], nullptr, &actions_before[n]);
    if (actions_before[n].sa_handler != SIG_IGN) sigaction(kSignals[n], &action, nullptr);
  }
}

CrashStop::~CrashStop() {
  for (std::size_t n = 0; n < kSignals.size(); ++n) sigaction(kSignals[n], &actions_before[n], nullptr);
  the_one.store(nullptr);
  is_over.store(true);
}

// Only what is safe in a signal's handler from here on.
void CrashStop::handle(int signal) {
  const int error = errno;
  if (only_stops(signal)) {
    CrashStop* const stop = the_one.load();
    if (stop != nullptr) stop->wait_until_let_go();
    raise(SIGSTOP);
    if (stop != nullptr) stop->device_.take_hold();
    errno = error;
    return;
  }
  if (CrashStop* stop = the_one.exchange(nullptr)) {
    stop->end();
    is_over.store(true);
  } else {
    // Another thread is at it, and this signal may not end it before.
    for (int n = 0; n < 2 * kWaits && !is_over.load(); ++n) nanosleep(&kWait, nullptr);
  }
  for (std::size_t n = 0; n < kSignals.size(); ++n) {
    if (kSignals[n] == signal) sigaction(signal, &actions_before[n], nullptr);
  }
  // A fault comes again by itself when this returns; a signal that was sent does not.
  raise(signal);
  errno = error;
}

void CrashStop::end() {
  asked_.store(true, std::memory_order_release);
  for (int n = 0; n < kWaits && !stopped_.load(std::memory_order_acquire); ++n) nanosleep(&kWait, nullptr);
  wait_until_let_go();
}

void CrashStop::wait_until_let_go() {
  for (int n = 0; n < kWaits && !device_.let_go(); ++n) nanosleep(&kWait, nullptr);
}

}  // namespace osteomill
