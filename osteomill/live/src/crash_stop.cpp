#include "osteomill/live/crash_stop.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <ctime>
#include <memory>
#include <mutex>

namespace osteomill {

// Entry through which handlers find a device. Entries are reused and never destroyed, so that a handler may
// go through all of them whatever other threads do.
struct Place {
  std::atomic<DrivenDevice*> driven{nullptr};
  Place* next = nullptr;
};

namespace {

// All whose default action ends or stops a process, but those that are never handed to it.
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
constexpr int kWaits = 50;
constexpr timespec kWait{0, 1'000'000};
constexpr std::size_t kStackBytes = 1 << 16;

std::atomic<Place*> places{nullptr};
// How many handlers are going through them.
std::atomic<int> handlers_at_places{0};

// Holds the action of a signal before it was handled here.
struct Taken {
  struct sigaction before {};
  bool is_taken = false;
};
std::array<Taken, kSignals.size()> taken;
// Guards the count of CrashStop objects and their changes to signals.
std::mutex mutex;
int objects = 0;

std::atomic<bool> ending{false};
std::atomic<bool> has_ended{false};

template <typename Condition>
void wait_for(const Condition& condition) {
  for (int n = 0; n < kWaits && !condition(); ++n) nanosleep(&kWait, nullptr);
}

// Gives a thread a stack for handlers until it ends, unless it has one already (from a sanitizer).
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

// Gives handlers access to all devices.
struct DrivenDevices {
  DrivenDevices() { handlers_at_places.fetch_add(1); }
  ~DrivenDevices() { handlers_at_places.fetch_sub(1); }
  DrivenDevices(const DrivenDevices&) = delete;
  DrivenDevices& operator=(const DrivenDevices&) = delete;

  template <typename Ask>
  bool all(const Ask& ask) const {
    bool all = true;
    for (Place* place = places.load(); place != nullptr; place = place->next) {
      DrivenDevice* const driven = place->driven.load();
      if (driven != nullptr && !ask(*driven)) all = false;
    }
    return all;
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
      driven.end_asked_.store(true, std::memory_order_release);
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

Taken& taken_of(int signal) {
  return taken[static_cast<std::size_t>(std::ranges::find(kSignals, signal) - kSignals.begin())];
}

void pass_to(const struct sigaction& before, int signal, siginfo_t* info, void* context) {
  // Resets the handler as the system would have done.
  if ((before.sa_flags & static_cast<int>(SA_RESETHAND)) != 0) ::signal(signal, SIG_DFL);
  if ((before.sa_flags & SA_SIGINFO) != 0) {
    before.sa_sigaction(signal, info, context);
  } else {
    before.sa_handler(signal);
  }
}

void end_by(int signal) {
  if (!ending.exchange(true)) {
    DrivenDevices().end();
    has_ended.store(true);
  } else {
    // Another thread is at it, and this signal may not end the process before.
    wait_for([] { return has_ended.load(); });
    wait_for([] { return has_ended.load(); });
  }
  ::signal(signal, SIG_DFL);
  // A fault comes again by itself when its handler returns; a signal that was sent does not.
  raise(signal);
}

// Only what is safe in a signal's handler from here on.
void handle(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  const struct sigaction& before = taken_of(signal).before;
  if (has_handler(before)) {
    CrashStop::disengage();
    pass_to(before, signal, info, context);
    CrashStop::engage();
  } else if (only_stops(signal)) {
    CrashStop::disengage();
    raise(SIGSTOP);
    CrashStop::engage();
  } else {
    end_by(signal);
  }
  errno = error;
}

bool is_ours(const struct sigaction& action) {
  return (action.sa_flags & SA_SIGINFO) != 0 && action.sa_sigaction == &handle;
}

bool may_be_taken(int signal, const struct sigaction& now) {
  if (has_handler(now)) return is_fault(signal);
  return now.sa_handler == SIG_DFL;
}

void take(int signal) {
  Taken& of = taken_of(signal);
  // One that the program has taken over since may pass it on to us, so we may not pass it back.
  if (of.is_taken) return;
  struct sigaction now {};
  sigaction(signal, nullptr, &now);
  if (!may_be_taken(signal, now)) return;
  of = {now, true};
  struct sigaction own {};
  own.sa_sigaction = &handle;
  // One at a time in a thread.
  sigfillset(&own.sa_mask);
  own.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  sigaction(signal, &own, nullptr);
}

void give_back(int signal) {
  Taken& of = taken_of(signal);
  struct sigaction now {};
  sigaction(signal, nullptr, &now);
  if (!of.is_taken || !is_ours(now)) return;
  sigaction(signal, &of.before, nullptr);
  of.is_taken = false;
}

}  // namespace

void CrashStop::give_this_thread_a_stack() {
  thread_local const StackOfHandlers stack;
}

CrashStop::CrashStop() {
  give_this_thread_a_stack();
  const std::lock_guard lock(mutex);
  if (objects++ == 0) std::ranges::for_each(kSignals, take);
}

CrashStop::~CrashStop() {
  const std::lock_guard lock(mutex);
  if (--objects == 0) std::ranges::for_each(kSignals, give_back);
}

void CrashStop::disengage() noexcept {
  DrivenDevices().disengage();
}

void CrashStop::engage() noexcept {
  DrivenDevices().engage();
}

DrivenDevice::DrivenDevice(Device& device) : device_(device) {
  for (place_ = places.load(); place_ != nullptr; place_ = place_->next) {
    DrivenDevice* nobody = nullptr;
    if (place_->driven.compare_exchange_strong(nobody, this)) return;
  }
  place_ = new Place{.driven = this, .next = places.load()};
  while (!places.compare_exchange_weak(place_->next, place_)) {
  }
}

DrivenDevice::~DrivenDevice() {
  place_->driven.store(nullptr);
  while (handlers_at_places.load() != 0) nanosleep(&kWait, nullptr);
}

}  // namespace osteomill
