#include "osteomill/live/crash_stop.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <ctime>
#include <memory>
#include <mutex>

#include "osteomill/base/signal_cleanup.h"

namespace osteomill {

// Entry through which handlers find a device. Entries are reused but never freed, so that a handler may walk
// the list whatever other threads do.
struct DeviceSlot {
  std::atomic<DrivenDevice*> driven{nullptr};
  DeviceSlot* next = nullptr;
};

namespace {

// All signals whose default action ends or stops a process, except those that cannot be caught.
constexpr std::array kSignals{SIGSEGV, SIGBUS,    SIGFPE,  SIGILL,  SIGABRT, SIGSYS,  SIGTRAP,
                              SIGQUIT, SIGTERM,   SIGHUP,  SIGINT,  SIGXCPU, SIGXFSZ, SIGPIPE,
                              SIGALRM, SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGPOLL, SIGSTKFLT,
                              SIGPWR,  SIGTSTP,   SIGTTIN, SIGTTOU};
constexpr bool only_stops(int signal) {
  return signal == SIGTSTP || signal == SIGTTIN || signal == SIGTTOU;
}
constexpr bool is_fault(int signal) {
  return signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL || signal == SIGABRT ||
         signal == SIGSYS;
}
constexpr int kMaxWaits = 50;
constexpr timespec kWait{0, 1'000'000};
constexpr std::size_t kStackBytes = 1 << 16;

std::atomic<DeviceSlot*> device_slots{nullptr};
// Number of handlers that are walking the list.
std::atomic<int> handlers_in_slots{0};

// Action of a signal before CrashStop handled it.
struct SignalAction {
  struct sigaction before {};
  bool is_handled = false;
};
std::array<SignalAction, kSignals.size()> signal_actions;
// Guards the count of CrashStop objects and their changes to signals.
std::mutex mutex;
int object_count = 0;

std::atomic<bool> ending{false};
std::atomic<bool> has_ended{false};

template <typename Condition>
void wait_for(const Condition& condition) {
  for (int n = 0; n < kMaxWaits && !condition(); ++n) nanosleep(&kWait, nullptr);
}

// Gives a thread an alternate signal stack until it ends, unless it has one already (from a sanitizer).
class SignalStack {
 public:
  SignalStack() {
    stack_t before{};
    sigaltstack(nullptr, &before);
    if ((before.ss_flags & SS_DISABLE) == 0) return;
    memory_ = std::make_unique<char[]>(kStackBytes);
    stack_t own{};
    own.ss_sp = memory_.get();
    own.ss_size = kStackBytes;
    sigaltstack(&own, nullptr);
  }
  ~SignalStack() {
    if (!memory_) return;
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    sigaltstack(&none, nullptr);
  }
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  std::unique_ptr<char[]> memory_;
};

}  // namespace

// Gives signal handlers access to all devices.
struct DrivenDevices {
  DrivenDevices() { handlers_in_slots.fetch_add(1); }
  ~DrivenDevices() { handlers_in_slots.fetch_sub(1); }
  DrivenDevices(const DrivenDevices&) = delete;
  DrivenDevices& operator=(const DrivenDevices&) = delete;

  template <typename Ask>
  bool all(const Ask& ask) const {
    bool all_true = true;
    for (DeviceSlot* slot = device_slots.load(); slot != nullptr; slot = slot->next) {
      DrivenDevice* const driven = slot->driven.load();
      if (driven != nullptr && !ask(*driven)) all_true = false;
    }
    return all_true;
  }
  void disengage() const {
    wait_for([&] { return all([](DrivenDevice& driven) { return driven.device_.disengage(); }); });
  }
  void engage() const {
    all([](DrivenDevice& driven) {
      driven.device_.engage();
      return true;
    });
  }
  void end() const {
    all([](DrivenDevice& driven) {
      driven.stop_requested_.store(true, std::memory_order_release);
      return true;
    });
    wait_for([&] {
      return all(
          [](const DrivenDevice& driven) { return driven.is_stopped_.load(std::memory_order_acquire); });
    });
    disengage();
  }
};

namespace {

bool has_handler(const struct sigaction& action) {
  return (action.sa_flags & SA_SIGINFO) != 0 ||
         (action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN);
}

SignalAction& action_of(int signal) {
  return signal_actions[static_cast<std::size_t>(std::ranges::find(kSignals, signal) - kSignals.begin())];
}

void pass_to(const struct sigaction& before, int signal, siginfo_t* info, void* context) {
  // Reset the handler as the system would have done.
  if ((before.sa_flags & static_cast<int>(SA_RESETHAND)) != 0) ::signal(signal, SIG_DFL);
  if ((before.sa_flags & SA_SIGINFO) != 0) {
    before.sa_sigaction(signal, info, context);
  } else {
    before.sa_handler(signal);
  }
}

void stop_devices() {
  if (!ending.exchange(true)) {
    DrivenDevices().end();
    has_ended.store(true);
  } else {
    // Another thread is ending the devices; this signal must not end the process before it is done.
    wait_for([] { return has_ended.load(); });
    wait_for([] { return has_ended.load(); });
  }
}

void end_process(int signal) {
  stop_devices();
  ::signal(signal, SIG_DFL);
  // A fault recurs by itself when its handler returns; a sent signal does not.
  raise(signal);
}

// From here on only async-signal-safe code.
void handle_signal(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  const struct sigaction& before = action_of(signal).before;
  if (has_handler(before)) {
    CrashStop::disengage();
    pass_to(before, signal, info, context);
    CrashStop::engage();
  } else if (only_stops(signal)) {
    CrashStop::disengage();
    raise(SIGSTOP);
    CrashStop::engage();
  } else {
    end_process(signal);
  }
  errno = error;
}

bool is_own_handler(const struct sigaction& action) {
  return (action.sa_flags & SA_SIGINFO) != 0 && action.sa_sigaction == &handle_signal;
}

bool can_be_handled(int signal, const struct sigaction& now) {
  if (has_handler(now)) return is_fault(signal);
  return now.sa_handler == SIG_DFL;
}

void install_handler(int signal) {
  SignalAction& action = action_of(signal);
  // If the program has since installed its own handler, that may chain to ours, so ours must not chain back
  // to it.
  if (action.is_handled) return;
  struct sigaction now {};
  sigaction(signal, nullptr, &now);
  if (!can_be_handled(signal, now)) return;
  action = {now, true};
  struct sigaction own {};
  own.sa_sigaction = &handle_signal;
  // Block other signals, so that handlers do not nest within a thread.
  sigfillset(&own.sa_mask);
  own.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  sigaction(signal, &own, nullptr);
}

void restore_handler(int signal) {
  SignalAction& action = action_of(signal);
  struct sigaction now {};
  sigaction(signal, nullptr, &now);
  if (!action.is_handled || !is_own_handler(now)) return;
  sigaction(signal, &action.before, nullptr);
  action.is_handled = false;
}

}  // namespace

void CrashStop::install_signal_stack() {
  thread_local const SignalStack stack;
}

CrashStop::CrashStop() {
  install_signal_stack();
  const std::lock_guard lock(mutex);
  if (object_count++ != 0) return;
  std::ranges::for_each(kSignals, install_handler);
  set_before_signal_cleanup(&stop_devices);
}

CrashStop::~CrashStop() {
  const std::lock_guard lock(mutex);
  if (--object_count != 0) return;
  set_before_signal_cleanup(nullptr);
  std::ranges::for_each(kSignals, restore_handler);
}

void CrashStop::disengage() noexcept {
  DrivenDevices().disengage();
}

void CrashStop::engage() noexcept {
  DrivenDevices().engage();
}

DrivenDevice::DrivenDevice(Device& device) : device_(device) {
  for (slot_ = device_slots.load(); slot_ != nullptr; slot_ = slot_->next) {
    DrivenDevice* expected = nullptr;
    if (slot_->driven.compare_exchange_strong(expected, this)) return;
  }
  slot_ = new DeviceSlot{.driven = this, .next = device_slots.load()};
  while (!device_slots.compare_exchange_weak(slot_->next, slot_)) {
  }
}

DrivenDevice::~DrivenDevice() {
  slot_->driven.store(nullptr);
  while (handlers_in_slots.load() != 0) nanosleep(&kWait, nullptr);
}

}  // namespace osteomill
