#include "osteomill/live/crash_stop.h"

#include <array>
#include <csignal>
#include <cstddef>
#include <ctime>

namespace osteomill {

namespace {

constexpr std::array kSignals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGHUP, SIGINT};
constexpr int kWaits = 50;
constexpr long kWait_ns = 1'000'000;

std::atomic<CrashStop*> the_one{nullptr};
std::array<struct sigaction, kSignals.size()> actions_before;

}  // namespace

CrashStop::CrashStop(Device& device) : device_(device) {
  the_one.store(this);
  struct sigaction action {};
  action.sa_handler = &CrashStop::handle;
  for (std::size_t n = 0; n < kSignals.size(); ++n) sigaction(kSignals[n], &action, &actions_before[n]);
}

CrashStop::~CrashStop() {
  for (std::size_t n = 0; n < kSignals.size(); ++n) sigaction(kSignals[n], &actions_before[n], nullptr);
  the_one.store(nullptr);
}

// Only what is safe in a signal's handler from here on.
void CrashStop::handle(int signal) {
  if (CrashStop* stop = the_one.exchange(nullptr)) stop->stop_the_device();
  for (std::size_t n = 0; n < kSignals.size(); ++n) {
    if (kSignals[n] == signal) sigaction(signal, &actions_before[n], nullptr);
  }
  // A fault comes again by itself when this returns; a signal that was sent does not.
  raise(signal);
}

void CrashStop::stop_the_device() {
  asked_.store(true, std::memory_order_release);
  const timespec wait{0, kWait_ns};
  for (int n = 0; n < kWaits && !stopped_.load(std::memory_order_acquire); ++n) nanosleep(&wait, nullptr);
  for (int n = 0; n < kWaits && !device_.let_go(); ++n) nanosleep(&wait, nullptr);
}

}  // namespace osteomill
