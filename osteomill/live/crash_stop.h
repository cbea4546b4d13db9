#pragma once

#include <atomic>

#include "osteomill/device/device.h"

namespace osteomill {

/// Sends a device zero however the program ends or is stopped, in any thread, but by SIGKILL and SIGSTOP
/// (then it is for the device to let go): when it crashes (with SIGABRT that is an exception that nobody
/// catches), is asked to end, or is stopped from its terminal, after which SIGCONT goes on with the device.
/// The signal then does what it did before; one that is ignored stays so. One at a time; made before the
/// haptic thread starts ticking, destroyed after it has ended.
///
/// Where it ends, the haptic thread is asked to stop and given 50 ms to send zero itself (it may be the one
/// that crashed); then the device is let go of from the signal's handler, and given 50 ms to say that zero
/// has gone out.
class CrashStop {
 public:
  explicit CrashStop(Device& device);
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  /// Gives the calling thread a stack for the signal's handler, in case its own overflows; the thread that
  /// makes this object has one. Where the stack of a thread without one overflows, no zero is sent.
  static void give_this_thread_a_stack();
  /// For the haptic thread, at every tick: true when it is to send zero and call `stopped`. Real-time safe.
  bool asked() const { return asked_.load(std::memory_order_acquire); }
  void stopped() { stopped_.store(true, std::memory_order_release); }

 private:
  static void handle(int signal);
  void end();
  void wait_until_let_go();

  Device& device_;
  std::atomic<bool> asked_{false};
  std::atomic<bool> stopped_{false};
};

}  // namespace osteomill
