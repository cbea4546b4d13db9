#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "osteomill/base/latest_value.h"
#include "osteomill/live/crash_stop.h"
#include "osteomill/live/live_timing.h"
#include "osteomill/session/milling_session.h"

namespace osteomill {

template <typename T>
class SpscQueue;

/// Called by the haptic thread in every tick, after the wrench was sent, with the tick's record, the bone and
/// its changed voxels. Must follow the rules of the tick: no allocation, lock, log, exception or system call.
using TickListener = std::function<void(const TickRecord&, const Volume&, const VolumeChange&)>;

/// The state after a tick (HapticThread::state).
struct LiveState {
  TickRecord record;
  bool spindle_on = false;
  /// MillingSession::intersection_W.
  std::optional<Vec3> intersection_W = {};
};

/// Thread that ticks a milling session in real time, at the rate of its setup (1 kHz), with real-time
/// scheduling if the system permits it. Other threads never make a tick wait. Most programs want LiveMilling
/// instead, which runs a HapticThread and adds undo, recordings and changes of algorithm, tool and bone.
///
/// One other thread (the window's) sends commands and reads the state. Commands take effect between two ticks
/// and return after that, a tick or two later. Whenever the thread stops, for whatever reason, the device is
/// sent a zero wrench; also if a signal ends the process, provided that the program has enabled it
/// (CrashStop).
class HapticThread {
 public:
  /// Takes ownership of the session. `device` outlives this object; `time_s` is the time of the first tick.
  /// Does not start the thread.
  HapticThread(std::unique_ptr<MillingSession> session, Device& device, TickClock clock = {},
               double time_s = 0);
  ~HapticThread();
  HapticThread(const HapticThread&) = delete;
  HapticThread& operator=(const HapticThread&) = delete;

  /// Starts the haptic thread and returns when it runs; does nothing if it runs already. Throws
  /// std::system_error if no thread can be created; the session is then not running and can be started again.
  void start();
  /// Stops the haptic thread and returns after the last tick, when zero has been sent. It can be started
  /// again.
  void stop();

  /// Switches the spindle. The device's own button or pedal also turns it on.
  void set_spindle(bool on);
  /// Pauses or resumes. While paused, zero is sent and neither the algorithm nor milling runs.
  void set_paused(bool paused);
  /// Freezes or unfreezes the bone. While frozen nothing is milled but forces continue, and other threads may
  /// read the volume.
  void freeze_bone(bool frozen);
  /// Continues with another algorithm, tool, setting or bone, prepared beforehand. Returns the state from
  /// which the new session started.
  SessionHandover replace(std::unique_ptr<MillingSession> session);
  /// Moves the tool to a pose free of bone, however far away. The wrench fades out over
  /// GuardSettings::blend_s, in which nothing is milled, so that the hand feels no step; then the device is
  /// moved there (Device::put_at) and the algorithm is reset. Does nothing while `is_placing`.
  void place(const Pose& X_WD);
  /// Returns whether a `place` is under way.
  bool is_placing() const { return placing_.load(std::memory_order_acquire); }
  /// Replaces the listener; an empty one removes it.
  void set_listener(TickListener listener);

  /// Returns the state after the last tick.
  const LiveState& state() { return state_.read(); }
  /// Returns the records of all ticks, one per call. The queue holds 4 s at 4 kHz; records are lost if it is
  /// full.
  std::optional<TickRecord> next_record();
  /// Returns timing statistics. Any thread.
  TimingSummary timing() const { return timing_.summary(); }
  /// Returns one line on what real-time scheduling the system refused; empty if none. Valid once started.
  const std::string& refused_real_time() const { return refused_real_time_; }
  bool is_running() const { return running_.load(std::memory_order_acquire); }
  /// Returns the exception, thrown by the device, that ended the session; null while it runs, or if `stop` or
  /// a signal ended it. For the commanding thread.
  std::exception_ptr failure() const { return is_running() ? nullptr : failure_; }

  /// Returns the session in use. Read its volume's densities only while frozen or not running.
  const MillingSession& session() const { return *session_; }
  /// Returns how many sessions were replaced so far.
  std::uint32_t session_number() const { return session_number_; }

 private:
  void run_between_ticks(const std::function<void()>& command);
  void run_pending_command();
  void run(const std::stop_token& stop) noexcept;
  void tick_until(const std::stop_token& stop);
  void place_if_at_rest();
  TickRecord tick(double late_s);

  TickClock clock_;
  Device& device_;
  DrivenDevice driven_;
  std::atomic<bool> running_{false};
  std::string refused_real_time_;
  std::exception_ptr failure_;

  // Used by the haptic thread alone while it runs.
  std::unique_ptr<MillingSession> session_;
  TickListener listener_;
  bool spindle_ = false;
  bool paused_ = false;
  bool bone_frozen_ = false;
  double time_s_;
  std::uint32_t session_number_ = 0;
  Pose X_WD_place_;
  bool fading_out_ = false;
  std::atomic<bool> placing_{false};

  // Set by the commanding thread, which then waits until the haptic thread has run it and reset this to null.
  std::atomic<const std::function<void()>*> command_{nullptr};

  std::unique_ptr<SpscQueue<TickRecord>> records_;
  LatestValue<LiveState> state_;
  LiveTiming timing_;
  // Last, so that the thread ends before the members it uses are destroyed.
  std::jthread thread_;
};

}  // namespace osteomill
