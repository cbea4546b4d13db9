#pragma once

#include <atomic>

#include "osteomill/session/device.h"

namespace osteomill {

/// Sends zero to every device driven by a live session when the process ends or is stopped, in any thread,
/// except by SIGKILL and SIGSTOP (then the device's own timeout must release it). A program enables this by
/// creating an object of this class, best at the beginning of main(); without one the library handles no
/// signal.
///
/// Handles only signals that the program does not handle and whose default action would end or stop the
/// process: crashes (SIGABRT also comes from an uncaught exception), requests to end, and stops from the
/// terminal, after which SIGCONT resumes the device. The default action then follows. Signals that the
/// program ignores or handles, before or later, are left to it. The handler of `install_signal_cleanup`
/// releases the devices too, whichever of the two was installed first. Only a fault (SIGSEGV, SIGBUS, SIGFPE,
/// SIGILL, SIGABRT, SIGSYS) that already had a handler is passed to that handler with the devices at zero; if
/// it returns, the sessions continue. A program that handles a fault in any other way calls `disengage` and
/// `engage` in its own handler.
///
/// When the process ends, the haptic threads are asked to stop and have 50 ms to send zero themselves (one of
/// them may have crashed). Then the signal handler releases the devices, which have 50 ms to report that zero
/// was sent.
///
/// Any number of objects may be created and destroyed, in any order and by any thread, also while sessions
/// run. With the last one every signal gets back the action it had before the first, unless the program has
/// meanwhile installed a handler of its own, which stays.
class CrashStop {
 public:
  CrashStop();
  ~CrashStop();
  CrashStop(const CrashStop&) = delete;
  CrashStop& operator=(const CrashStop&) = delete;

  /// Gives the calling thread an alternate signal stack, unless it has one, in case its own stack overflows.
  /// The thread that creates this object and every haptic thread get one. If the stack of a thread without
  /// one overflows, no zero is sent.
  static void install_signal_stack();

  /// Makes all live devices send zero until `engage`, and waits up to 50 ms until zero is sent. For the
  /// program's own signal handlers; any thread, with or without an object of this class.
  static void disengage() noexcept;
  /// Ends `disengage`: the sessions' wrenches are sent again, ramped up slowly. For the same callers.
  static void engage() noexcept;
};

/// Registers a device that a haptic thread drives with CrashStop for the lifetime of this object.
/// HapticThread has one; needed only for a program's own haptic loop.
class DrivenDevice {
 public:
  /// Registers the device, which must outlive this object and must not be driven yet.
  explicit DrivenDevice(Device& device);
  /// Returns once no signal handler uses the device any more.
  ~DrivenDevice();
  DrivenDevice(const DrivenDevice&) = delete;
  DrivenDevice& operator=(const DrivenDevice&) = delete;

  /// Returns true if the haptic thread has to send zero and call `note_stopped`. Check in every tick;
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
  // Never freed, because signal handlers may still read it.
  struct DeviceSlot* slot_;
};

}  // namespace osteomill
