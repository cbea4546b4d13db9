#pragma once

#include <csignal>
#include <optional>
#include <string>

namespace osteomill {

/// Requests real-time scheduling (SCHED_FIFO) for the calling thread and locks the program's current memory
/// in RAM (mlockall). Returns one line with what the system refused and why, or nothing; the program can
/// continue without it. Makes system calls: call before the first tick, not in it.
std::optional<std::string> request_real_time();

/// Blocks signals in the constructing thread, and in threads that it starts, until this object is destroyed.
/// Faults of the thread itself (SIGSEGV and the like) still arrive. Needed because the signal handler of
/// CrashStop waits for the threads that drive a device.
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
