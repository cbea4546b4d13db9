#pragma once

#include <csignal>
#include <optional>
#include <string>

namespace osteomill {

/// Asks the system to run the calling thread before all ordinary ones (SCHED_FIFO) and to keep the program's
/// memory as it is now in RAM (mlockall). Returns in one line what the system refused and why, if it refused
/// anything; the program goes on without it. Makes system calls: before the first tick, not in it.
std::optional<std::string> request_real_time();

/// Keeps signals away from the thread that makes it, and from any thread that this one starts, until it is
/// destroyed. They receive only the signals of their own faults, because the code that handles one
/// (CrashStop) waits for the threads that drive a device.
class BlockedSignals {
 public:
  BlockedSignals();
  ~BlockedSignals();
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace osteomill
