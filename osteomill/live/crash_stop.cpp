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
std::array<struct sigaction, kSignals.size()> actions_before;

}  // namespace

void CrashStop::give_this_thread_a_stack() {
  thread_local const auto memory = std::make_unique<char[]>(kStackBytes);
  stack_t stack{};
  stack.ss_sp = memory.get();
  stack.ss_size = kStackBytes;
  sigaltstack(&stack, nullptr);
}

CrashStop::CrashStop(Device& device) : device_(device) {
  give_this_thread_a_stack();
  the_one.store(this);
  struct sigaction action {};
  action.sa_handler = &CrashStop::handle;
  action.sa_flags = SA_ONSTACK | SA_RESTART;
  for (std::size_t n = 0; n < kSignals.size(); ++n) {
    sigaction(kSignals[n], nullptr, &actions_before[n]);
    if (actions_before[n].sa_handler != SIG_IGN) sigaction(kSignals[n], &action, nullptr);
  }
}

CrashStop::~CrashStop() {
  for (std::size_t n = 0; n < kSignals.size(); ++n) sigaction(kSignals[n], &actions_before[n], nullptr);
  the_one.store(nullptr);
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
  if (CrashStop* stop = the_one.exchange(nullptr)) stop->end();
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
