#pragma once

#include <atomic>

#include "osteomill/session/device.h"

namespace osteomill {

/// Sends zero to every device that a live session drives when the program ends or is stopped, in any thread,
/// except by SIGKILL and SIGSTOP (then the device must let go by itself). A program asks for that by making
/// one object of this class, best at the beginning of main(); without one the library handles no signal.
///
/// It handles only signals that the program does not handle and whose default action would end or stop the
/// process: after a crash (SIGABRT also comes from an exception that is not caught), a request to end, or a
/// stop from the terminal, after which SIGCONT continues with the device. The default action then follows.
/// Signals that the program ignores or handles, before or later, are left to it; the handler of
/// `install_signal_cleanup` lets go of the devices as this class does, whichever of the two came first. Only
/// a fault (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS) that had a handler before is passed to that one
/// with the devices at zero, and if it returns, the sessions go on; a program that handles a fault in any
/// other way calls `disengage` and `engage` in its own handler.
///
/// When the process ends, the haptic threads are asked to stop and given 50 ms to send zero themselves (one
/// of them may have crashed); then the devices are let go of from the signal's handler, and given 50 ms to
/// tell that zero has gone out.
///
/// There may be any number of objects, made and destroyed in any order and by any thread, also while sessions
/// run; with the last one every signal goes back to what it did before the first, unless the program has set
/// a handler of its own in the meantime, which stays.
class CrashStop {
 public:
  CrashStop();
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  /// Gives the calling thread a stack for signal handlers, in case its own overflows, unless it has one; the
  /// thread that makes this object and every haptic thread get one. When the stack of a thread without one
  /// overflows, no zero is sent.
  static void install_signal_stack();

  /// Has all live devices sent zero until `engage`, and waits up to 50 ms until it has gone out. For a
  /// signal handler of the program's own; any thread, with or without an object of this class.
  static void disengage() noexcept;
  /// Ends what `disengage` began: what the sessions ask for is sent again, and comes up slowly. For the same
  /// callers.
  static void engage() noexcept;
};

/// Makes a device that a haptic thread drives known to CrashStop as long as this object lives. HapticThread
/// has one; only a loop of its own that is to stop as safely needs another.
class DrivenDevice {
 public:
  /// Makes the device known. It outlives this object, and no thread drives it yet.
  explicit DrivenDevice(Device& device);
  /// Returns once no signal handler uses the device any more.
  ~DrivenDevice();
  DrivenDevice(const DrivenDevice&) = delete;
  DrivenDevice& operator=(const DrivenDevice&) = delete;

  /// Returns true when the haptic thread is to send zero and call `note_stopped`. Asked at every tick;
  /// real-time safe.
  bool is_stop_requested() const { return stop_requested_.load(std::memory_order_acquire); }
  /// Notes that the haptic thread begins to drive the device. Real-time safe.
  void note_started() { is_stopped_.store(false, std::memory_order_release); }
  /// Notes that the haptic thread has sent zero for the last time. Real-time safe.
  void note_stopped() { is_stopped_.store(true, std::memory_order_release); }

 private:
  friend struct DrivenDevices;
  Device& device_;
  std::atomic<bool> stop_requested_{false};
  std::atomic<bool> is_stopped_{true};
  // Handlers only read it, so that it stays where it is.
  struct DeviceSlot* slot_;
};

}  // namespace osteomill
