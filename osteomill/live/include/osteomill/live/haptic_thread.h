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

/// A function that the haptic thread calls in every tick, after the wrench has gone out: with its record, the
/// bone, and where it changed. Must keep to the rules of the tick: no allocation, lock, log, exception or
/// system call.
using TickListener = std::function<void(const TickRecord&, const Volume&, const VolumeChange&)>;

/// The state after a tick (HapticThread::state).
struct LiveState {
  TickRecord record;
  bool spindle_on = false;
  /// MillingSession::intersection_W.
  std::optional<Vec3> intersection_W = {};
};

/// The thread that ticks a milling session in real time, at the rate of its setup (1 kHz), with real-time
/// scheduling if the system allows it. Nothing that other threads do makes a tick wait. LiveMilling is what
/// most programs want: it runs one of these and adds undo, recordings and changes of algorithm, tool and
/// bone.
///
/// One other thread commands and reads the state (the window's). Commands take effect between two ticks and
/// return when they have, a tick or two later. On stopping, however it comes about, the device is sent a
/// wrench of zero; so it is when the process ends by a signal, if the program has asked for that
/// (CrashStop).
class HapticThread {
 public:
  /// Takes the session over. `device` outlives this object; `time_s` is the time of the first tick. Does not
  /// start yet.
  HapticThread(std::unique_ptr<MillingSession> session, Device& device, TickClock clock = {},
               double time_s = 0);
  ~HapticThread();
  HapticThread(const HapticThread&) = delete;
  HapticThread& operator=(const HapticThread&) = delete;

  /// Starts the haptic thread and returns when it runs; does nothing if it runs already. Throws
  /// std::system_error if the system gives no thread: the session is then not running, and can be started
  /// again.
  void start();
  /// Stops the haptic thread and returns when the last tick is over and zero has been sent. It can be started
  /// again.
  void stop();

  /// Switches the spindle. The device's own button or pedal turns it on as well.
  void set_spindle(bool on);
  /// Begins or ends a pause, which sends zero and neither steps nor mills.
  void set_paused(bool paused);
  /// Freezes or unfreezes the bone. While frozen, nothing is milled, though everything is felt, and other
  /// threads may read the volume.
  void freeze_bone(bool frozen);
  /// Goes on with another algorithm, tool, setting or bone, prepared beforehand. Returns the state in which
  /// that began.
  SessionHandover replace(std::unique_ptr<MillingSession> session);
  /// Brings the tool to a pose free of bone, however far away. The wrench fades in a hundred ticks, in which
  /// nothing is milled, so that the hand feels no step; then the device is put there (Device::put_at), and
  /// the algorithm begins again. One at a time: does nothing while `is_placing`.
  void place(const Pose& X_WD);
  /// Returns whether the tool is being brought to the pose given to `place`.
  bool is_placing() const { return placing_.load(std::memory_order_acquire); }
  /// Replaces the listener; an empty one for none.
  void set_listener(TickListener listener);

  /// Returns the state after the last tick.
  const LiveState& state() { return state_.read(); }
  /// Returns every tick's record in turn. The queue holds 4 s at 4 kHz; records that find it full are lost.
  std::optional<TickRecord> next_record();
  /// Returns how well the session keeps its time. From any thread.
  TimingSummary timing() const { return timing_.summary(); }
  /// Returns in one line what real-time scheduling the system refused; empty if nothing. Valid once started.
  const std::string& refused_real_time() const { return refused_real_time_; }
  bool is_running() const { return running_.load(std::memory_order_acquire); }
  /// Returns what ended the session by itself, as the device threw it; null while it runs, and if `stop` or a
  /// signal ended it. For the commanding thread.
  std::exception_ptr failure() const { return is_running() ? nullptr : failure_; }

  /// Returns the session now in use. Its volume's densities may be read only while frozen, or while not
  /// running.
  const MillingSession& session() const { return *session_; }
  /// Returns how many sessions were replaced before the one in use.
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

  // Set by the commanding thread, which waits until the haptic one has done it and made it null.
  std::atomic<const std::function<void()>*> command_{nullptr};

  std::unique_ptr<SpscQueue<TickRecord>> records_;
  LatestValue<LiveState> state_;
  LiveTiming timing_;
  // Last, so that it ends before all that it uses.
  std::jthread thread_;
};

}  // namespace osteomill
