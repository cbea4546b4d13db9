#pragma once

#include <atomic>

#include "osteomill/device/device.h"

namespace osteomill {

/// Sends a device zero when the program crashes in any thread (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, and
/// with the last an exception that nobody catches), and when it is asked to end by SIGTERM, SIGHUP or SIGINT.
/// The signal then does what it did before. One at a time; made before the haptic thread starts ticking,
/// destroyed after it has ended.
///
/// The haptic thread is asked to stop and given 50 ms to send zero itself (it may be the one that crashed);
/// then the device is let go of from the signal's handler, and given 50 ms to say that zero has gone out.
class CrashStop {
 public:
  explicit CrashStop(Device& device);
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  /// For the haptic thread, at every tick: true when it is to send zero and call `stopped`. Real-time safe.
  bool asked() const { return asked_.load(std::memory_order_acquire); }
  void stopped() { stopped_.store(true, std::memory_order_release); }

 private:
  static void handle(int signal);
  void stop_the_device();

  Device& device_;
  std::atomic<bool> asked_{false};
  std::atomic<bool> stopped_{false};
};

}  // namespace osteomill
