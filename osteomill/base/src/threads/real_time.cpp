#include "osteomill/base/real_time.h"

#include <cerrno>
#include <cstring>

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

namespace osteomill {

namespace {

// Above ordinary threads, below the kernel threads that serve the devices.
constexpr int kPriority = 40;

}  // namespace

std::optional<std::string> request_real_time() {
  std::string refused;
  sched_param priority{};
  priority.sched_priority = kPriority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority); error != 0) {
    refused = std::string("no real-time scheduling (") + std::strerror(error) +
              "): ticks will be late under load; set rtprio in /etc/security/limits.conf";
  }
  // Without MCL_FUTURE, because under a memory limit locking later allocations would make them fail. With
  // MCL_ONFAULT, because prefaulting pages for writing would duplicate those that copies of a bone share.
  if (mlockall(MCL_CURRENT | MCL_ONFAULT) != 0) {
    refused += std::string(refused.empty() ? "" : "; ") + "memory not locked (" + std::strerror(errno) + ")";
  }
  if (refused.empty()) return std::nullopt;
  return refused;
}

BlockedSignals::BlockedSignals() {
  sigset_t of_others;
  sigfillset(&of_others);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS})
    sigdelset(&of_others, own);
  pthread_sigmask(SIG_BLOCK, &of_others, &before_);
}

BlockedSignals::~BlockedSignals() {
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace osteomill
